//! The findings as one self-contained page.

use std::fmt::Write as _;
use std::io;

use morph_collision_models::text::Grouped;
use morph_collision_models::text::Printable;

use super::picture;
use super::report::{FindingReport, LintReport, MeshReport};
use crate::touching::depth::ThresholdArgs;

const PAGE_STYLE: &str = "body{font:15px/1.45 system-ui,sans-serif;margin:2em auto;max-width:76em;padding:0 1em;color:#222;background:#fff;overflow-wrap:anywhere}\
h1{font-size:1.5em}h2{font-size:1.15em;margin-top:2em}\
table{border-collapse:collapse;width:100%;table-layout:fixed;overflow-wrap:anywhere}th{text-align:left;border-bottom:2px solid #999;padding:.3em .6em}\
td{border-bottom:1px solid #ddd;padding:.5em .6em;vertical-align:top}td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}\
tr.accepted{opacity:.55}svg{width:240px;height:240px;background:#f3f4f5;border-radius:4px;display:block}\
.where{color:#555}input{font:12px ui-monospace,monospace;width:100%;box-sizing:border-box;margin-top:.4em;border:1px solid #ccc;padding:.25em}\
i.r,i.b{display:inline-block;width:.8em;height:.8em;border-radius:2px}i.r{background:#d8352a}i.b{background:#2468c8}\
@media(max-width:45em){body{margin:1em auto}thead{display:none}table,tbody,tr,td{display:block}tr{border-bottom:1px solid #ddd;padding:.6em 0}\
td,td.n{border:0;padding:.15em 0;text-align:left}td:first-child::before{content:\"depth \"}td:last-child::before{content:\"pairs \"}}";

/// Writes the page.
pub(super) fn write(report: &LintReport, out: &mut dyn io::Write) -> io::Result<()> {
    out.write_all(page(report).as_bytes())
}

/// The text of the page.
pub(super) fn page(report: &LintReport) -> String {
    let model = report.model.display().to_string();
    let title = format!("Lint of {}", escaped(&model));
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\
         <title>{title}</title><style>{PAGE_STYLE}{}</style></head><body>\n<h1>{title}</h1>\n",
        picture::STYLE
    );
    page += "<p>Where a mesh, or the meshes of a character, run into themselves although they do not at rest: with single targets, in clips and captures, with pairs of \
             targets, with expressions, and in mixtures, each the deepest first. Depth is how far one triangle would have to move to leave the one it touches, in the file's unit; a \
             negative one is the distance of triangles that do not touch. <i class=\"r\"></i> and <i class=\"b\"></i> touch each other. Click on \
             the weights to select them; they are options of <code>morph-collide query</code> and <code>export</code>.</p>\n";
    for mesh in &report.meshes {
        of_mesh(mesh, report.thresholds, &mut page);
    }
    page + "</body></html>\n"
}

fn of_mesh(mesh: &MeshReport, thresholds: ThresholdArgs, page: &mut String) {
    // Writing to a string cannot fail.
    let _ = writeln!(
        page,
        "<h2>Mesh {} \u{201c}{}\u{201d}</h2>\n<p>{} triangles, {} targets. {} shapes were tried. {} pairs of triangles {} at rest and are \
         not reported.{}</p>",
        mesh.mesh,
        escaped(&mesh.name),
        Grouped(mesh.triangles as u64),
        mesh.targets,
        Grouped(mesh.shapes as u64),
        Grouped(mesh.pairs_at_rest as u64),
        thresholds.many(),
        mesh.proof
            .as_ref()
            .map(|proof| format!(" {}", escaped(&proof.sentence())))
            .unwrap_or_default(),
    );
    if mesh.findings.is_empty() {
        *page += "<p>Nothing was found.</p>\n";
        return;
    }
    let _ = writeln!(page, "<p>{}</p>", escaped(&mesh.by_source()));
    *page += "<table><thead><tr><th class=\"n\" style=\"width:5em\">depth</th><th style=\"width:250px\">picture</th><th>found with</th><th class=\"n\" style=\"width:5em\">pairs</th></tr></thead><tbody>\n";
    for finding in &mesh.findings {
        row(finding, page);
    }
    *page += "</tbody></table>\n";
    if !mesh.suggestions.is_empty() {
        *page += "<h2>Limits</h2>\n<ul>\n";
        for suggestion in &mesh.suggestions {
            let _ = writeln!(page, "<li>{}</li>", escaped(&suggestion.words()));
        }
        *page += "</ul>\n";
    }
}

fn row(finding: &FindingReport, page: &mut String) {
    let class = if finding.accepted { " class=\"accepted\"" } else { "" };
    let accepted = if finding.accepted { " (accepted)" } else { "" };
    let _ = writeln!(
        page,
        "<tr{class}><td class=\"n\">{:.4}</td><td>{}</td><td><b>{}</b>{accepted}<br>{}<div class=\"where\">{}</div>\
         <input readonly onclick=\"this.select()\" value=\"{}\"></td><td class=\"n\">{}{}</td></tr>",
        finding.depth,
        finding.picture.as_deref().unwrap_or_default(),
        escaped(&finding.found_with),
        escaped(&finding.shape()),
        escaped(&finding.place()),
        escaped(&finding.reproduce),
        Grouped(finding.pairs as u64),
        if finding.is_truncated { "+" } else { "" },
    );
}

/// Text for HTML, in which names from a file can do no harm.
fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in Printable(text).to_string().chars() {
        match c {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            '\'' => safe += "&#39;",
            c => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_leave_their_place() {
        assert_eq!(
            escaped("<b onclick='x'>\"&"),
            "&lt;b onclick=&#39;x&#39;&gt;&quot;&amp;"
        );
    }
}
