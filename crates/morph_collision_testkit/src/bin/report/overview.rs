//! Writes all pages, and fills the tables of `performance.md` and the README.

use std::error::Error;
use std::fs;
use std::path::Path;

use morph_collision_testkit::bench;

use crate::comparison::{HYBRID, PARRY, rivals};
use crate::losses::losses_table;
use crate::page::Origins;
use crate::record::{ALL, FIRST, Record, Scene, scene, scenes};
use crate::store::Store;
use crate::table::ratio;
use crate::topics::{TOPICS, of_bodies, of_rays};

/// Writes everything that is made from the rows.
pub(crate) fn write(docs: &Path, store: &Store) -> Result<(), Box<dyn Error>> {
    // Read before anything is written, so that a wrong folder fails at once.
    let performance = performance(bench::Page::read(&docs.join("performance.md"))?, store)?;
    let readme = readme(bench::Page::read(&docs.join("../README.md"))?, store)?;
    fs::create_dir_all(&store.pages)?;
    for topic in &TOPICS {
        let path = store.pages.join(topic.name).with_extension("md");
        fs::write(&path, (topic.page)(store)?.text(store)).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    performance.write()?;
    Ok(readme.write()?)
}

fn performance(mut page: bench::Page, store: &Store) -> Result<bench::Page, Box<dyn Error>> {
    let (bodies, rays) = (of_bodies(store)?, of_rays(store)?);
    let mut measured = Origins::default();
    for (origin, title) in bodies.iter().chain(&rays).map(Record::origin) {
        measured.add(origin, title);
    }
    let mut losses = Vec::new();
    for topic in &TOPICS {
        losses.extend((topic.losses)(store)?);
    }
    page.replace("measured", &measured.to_string())?;
    page.replace(
        "rivals",
        &format!("\n{}\n", rivals(scenes(&bodies), "all pairs / first pairs")),
    )?;
    page.replace(
        "rays",
        &format!("\n{}\n", rivals(scenes(&rays), "one ray / a hundred rays")),
    )?;
    page.replace("losses", &format!("\n{}\n", losses_table(&losses)))?;
    Ok(page)
}

fn readme(mut page: bench::Page, store: &Store) -> Result<bench::Page, Box<dyn Error>> {
    let rows = of_bodies(store)?;
    if let Some(sentence) = scene(&rows, "dolphins-36096").and_then(fast) {
        page.replace("fast", &sentence)?;
    }
    Ok(page)
}

/// The README's sentence about speed, in a list.
fn fast(scene: Scene<'_>) -> Option<String> {
    let times = |methods, wanted| Some(ratio(scene.best(methods, wanted)?));
    Some(format!(
        "  On twelve dolphins of 36096 triangles, Parry's faster refit takes {} times as long as this library to find all intersecting triangles, and {}\n  \
           times to find one for each pair of bodies. The hybrid method from the literature takes {} and {} times.\n  ",
        times(PARRY, ALL)?,
        times(PARRY, FIRST)?,
        times(HYBRID, ALL)?,
        times(HYBRID, FIRST)?,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::tests::scene_of;

    #[test]
    fn the_readme_quotes_the_best_of_parrys_refits() {
        let rows = scene_of(
            "dolphins",
            &[
                ("hybrid", 7.2, 17.3),
                ("parry-trimesh", 66.0, 252.4),
                ("parry-bvh", 80.0, 240.0),
            ],
        );
        let sentence = scenes(&rows).next().and_then(fast).expect("all rivals are there");
        assert!(
            sentence.contains(
                "takes 66 times as long as this library to find all intersecting triangles, and 240\n  times"
            ),
            "{sentence}"
        );
        assert!(sentence.contains("takes 7.2 and 17 times"), "{sentence}");
    }

    /// If this fails, `just report --render` writes the documents anew.
    #[test]
    fn the_documents_say_what_the_measured_rows_say() -> Result<(), Box<dyn Error>> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let folder = tempfile::tempdir()?;
        let copy = folder.path().join("docs");
        let pages = root.join("docs/measurements");
        fs::create_dir_all(&copy)?;
        fs::copy(root.join("docs/performance.md"), copy.join("performance.md"))?;
        fs::copy(root.join("README.md"), folder.path().join("README.md"))?;
        write(&copy, &Store::below(&pages).with_pages(&copy.join("measurements")))?;
        let mut written = vec!["docs/performance.md".to_owned(), "README.md".to_owned()];
        written.extend(
            TOPICS
                .iter()
                .map(|topic| format!("docs/measurements/{}.md", topic.name)),
        );
        for file in written {
            let [stored, made] =
                [&root, &folder.path().to_owned()].map(|folder| fs::read_to_string(folder.join(&file)));
            assert!(
                stored? == made?,
                "{file} is not what its data says: run `just report --render`"
            );
        }
        Ok(())
    }
}
