//! Writes all pages, and fills the tables of `performance.md` and the README.

use std::error::Error;
use std::fs;
use std::path::Path;

use morph_collision_testkit::report::{Page as Sections, Store, Table};

use crate::report::comparison::{refitting_rivals, rivals};
use crate::report::losses::losses_table;
use crate::report::page::Origins;
use crate::report::record::{Record, scenes};
use crate::report::topics::{TOPICS, of_bodies, of_rays};

/// Writes everything that is made from the rows.
pub(crate) fn write(docs: &Path, store: &Store) -> Result<(), Box<dyn Error>> {
    // Read before anything is written, so that a wrong folder fails at once.
    let performance = performance(Sections::read(&docs.join("performance.md"))?, store)?;
    let readme = readme(Sections::read(&docs.join("../README.md"))?, store)?;
    fs::create_dir_all(store.pages())?;
    for topic in &TOPICS {
        let path = store.pages().join(topic.name).with_extension("md");
        fs::write(&path, (topic.page)(store)?.text(store)).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    performance.write()?;
    Ok(readme.write()?)
}

fn performance(mut page: Sections, store: &Store) -> Result<Sections, Box<dyn Error>> {
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

/// The scenes in the README: one for each kind of mesh, and a crowd.
const IN_README: [&str; 5] = [
    "dolphins-36096",
    "heads-cheek",
    "horse-gallop",
    "walkers-hands",
    "walkers-crowd",
];

fn readme(mut page: Sections, store: &Store) -> Result<Sections, Box<dyn Error>> {
    let rows = of_bodies(store)?;
    page.replace("fast", &format!("\n{}\n", readme_table(&rows)))?;
    Ok(page)
}

fn readme_table(rows: &[Record]) -> Table {
    let shown = scenes(rows).filter(|scene| IN_README.contains(&scene.name()));
    refitting_rivals(shown, "all pairs / first pairs")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::record::tests::scene_of;

    #[test]
    fn the_readme_has_few_scenes_and_the_rivals_that_refit() {
        let ratios = [
            ("hybrid", 7.2, 17.3),
            ("parry-trimesh", 66.0, 252.4),
            ("paper", 218.0, 865.0),
        ];
        let mut rows = scene_of("dolphins-564", &ratios);
        rows.extend(scene_of("dolphins-36096", &ratios));
        assert_eq!(
            readme_table(&rows).to_string(),
            "| all pairs / first pairs | hybrid | Parry, refitted |\n|---|--:|--:|\n\
             | The dolphins-36096 | 7.2 / 17 | 66 / 252 |\n"
        );
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
