//! Clips of other files: `FILE#NAME` where the name of a clip is expected.
//!
//! ```text
//! FILE --open, once--> BorrowedClip --lend, by the names of nodes--> clips of a body, called FILE#NAME
//! ```

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::{Path, PathBuf};

use morph_collision_models::gltf::read::{BorrowedClip, GltfFile, Matched};
use morph_collision_models::memory::{MemoryBudget, OverBudget};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::skeleton::Skeleton;
use morph_collision_models::text::Printable;
use morph_collision_models::text::suggestion;

use crate::error::CliError;
use crate::files::clips::{BrokenClips, ClipChoice, NoClip};
use crate::files::model::{FileArgs, has_extension};
use crate::messages;
use crate::messages::listed;

/// The clips of other files that bodies play.
pub(crate) struct ClipFiles<'a> {
    options: &'a FileArgs,
    budget: MemoryBudget,
    /// Paths are relative to this folder.
    folder: PathBuf,
    files: BTreeMap<PathBuf, GltfFile>,
    /// By what the user wrote.
    clips: BTreeMap<String, Lent>,
}

/// A clip of another file.
struct Lent {
    file: PathBuf,
    /// What the user wrote after the file.
    name: Option<String>,
    /// The name of the animation.
    animation: String,
    clip: BorrowedClip,
    /// What bodies took of it so far.
    matched: HashSet<String>,
    /// Names that several nodes of a model have.
    repeated: BTreeSet<String>,
}

impl<'a> ClipFiles<'a> {
    /// None yet. Paths are relative to a folder.
    pub(crate) fn new(options: &'a FileArgs, budget: &MemoryBudget, folder: &Path) -> Self {
        Self {
            options,
            budget: budget.clone(),
            folder: folder.to_owned(),
            files: BTreeMap::new(),
            clips: BTreeMap::new(),
        }
    }

    /// How far files are trusted.
    pub(crate) fn options(&self) -> &'a FileArgs {
        self.options
    }

    /// All files that were read.
    pub(crate) fn inputs(&self) -> Vec<PathBuf> {
        self.files.values().flat_map(GltfFile::files).collect()
    }

    /// Reads a clip of another file, unless `text` names an animation of `model` or no file.
    ///
    /// # Errors
    /// The file cannot be read, has no such animation, or the animation is broken. The message names the file.
    pub(crate) fn open(&mut self, text: &str, model: &GltfFile) -> Result<(), String> {
        if self.clips.contains_key(text) {
            return Ok(());
        }
        let Some((file, name)) = self.split(text) else {
            return Ok(());
        };
        if model.animation_named(text).is_some() {
            return Ok(());
        }
        if !self.files.contains_key(&file) {
            let opened = self.options.open_within(&file, &self.budget);
            self.files
                .insert(file.clone(), opened.map_err(|error| error.to_string())?);
        }
        let opened = &self.files[&file];
        let names = opened.animation_names();
        let index = animation(&file, &names, name)?;
        let clip = opened.borrowed_clip(index);
        let clip = clip.map_err(|error| CliError::from(error).to_string())?;
        let lent = Lent {
            file,
            name: name.map(str::to_owned),
            animation: names[index].clone(),
            clip,
            matched: HashSet::new(),
            repeated: BTreeSet::new(),
        };
        self.clips.insert(text.to_owned(), lent);
        Ok(())
    }

    /// The file and the name in `text`; `None` if it names no file. A file with the whole name wins.
    fn split<'t>(&self, text: &'t str) -> Option<(PathBuf, Option<&'t str>)> {
        let is_model = |file: &str| has_extension(Path::new(file), &["glb", "gltf"]);
        let whole = self.folder.join(text);
        if is_model(text) && whole.is_file() {
            return Some((whole, None));
        }
        let cuts = text.rmatch_indices('#').map(|(at, _)| (&text[..at], &text[at + 1..]));
        match cuts.into_iter().find(|(file, _)| is_model(file)) {
            Some((file, name)) => Some((self.folder.join(file), Some(name))),
            None => is_model(text).then_some((whole, None)),
        }
    }

    /// Adds a clip of another file to the clips of a body, under the name `text`; nothing if `text` names no file. The clips of the body's own
    /// file have been read. `placement` is how the node that shows the mesh moves.
    ///
    /// # Errors
    /// Those of [`ClipFiles::open`], and if the memory limit has no room for the clip.
    pub(crate) fn lend(
        &mut self,
        text: &str,
        model: &GltfFile,
        (index, node): (usize, Option<usize>),
        mesh: &mut MorphMesh,
        placement: Option<&mut Skeleton>,
    ) -> Result<(), String> {
        self.open(text, model)?;
        let Some(lent) = self.clips.get_mut(text) else {
            return Ok(());
        };
        let over = |over: OverBudget| format!("{over}; raise --memory-limit");
        let skeletons = [mesh.skin.as_mut().map(|skin| &mut skin.skeleton), placement];
        for skeleton in skeletons.into_iter().flatten() {
            let matched = lent.clip.for_skeleton(text, skeleton, &self.budget).map_err(over)?;
            skeleton.clips.extend(matched.map(|matched| lent.take(matched)));
        }
        if let Some(node) = node.or_else(|| model.main_node(index)) {
            let matched = lent.clip.for_weights(text, &model.node_name(node), mesh, &self.budget);
            mesh.animations
                .extend(matched.map_err(over)?.map(|matched| lent.take(matched)));
        }
        Ok(())
    }

    /// Like [`ClipChoice::find`], also for clips of other files, which have been lent to the body.
    pub(crate) fn find(
        &self,
        text: &str,
        model: &GltfFile,
        mesh: &MorphMesh,
        placement: Option<&Skeleton>,
        broken: &BrokenClips,
    ) -> Result<ClipChoice, NoClip> {
        match self.clips.get(text) {
            None => ClipChoice::find(text, model, mesh, placement, broken),
            // It is no name of the model's own animations.
            Some(lent) => ClipChoice::named(text, mesh, placement).ok_or_else(|| NoClip::Unknown(lent.no_match())),
        }
    }

    /// What to write for a clip in a scene file from which its file has another path.
    pub(crate) fn renamed(&self, text: &str, path: impl FnOnce(&Path) -> PathBuf) -> String {
        let Some(lent) = self.clips.get(text) else {
            return text.to_owned();
        };
        let file = path(&lent.file).display().to_string();
        match &lent.name {
            Some(name) => format!("{file}#{name}"),
            None => file,
        }
    }

    /// Says what fitted no body, once all bodies have their clips.
    pub(crate) fn warn(&self) {
        for lent in self.clips.values().filter(|lent| !lent.matched.is_empty()) {
            let unmatched: Vec<String> = lent.clip.parts().filter(|part| !lent.matched.contains(part)).collect();
            if !unmatched.is_empty() {
                lent.warn(&format!("the model has nothing of the name of {}", listed(&unmatched)));
            }
            match lent.clip.unnamed() {
                0 => {}
                count => {
                    let channels = messages::counted(count, "channel moves a node", "channels move nodes");
                    lent.warn(&format!("{channels} without a name, which fits no model"));
                }
            }
            if !lent.clip.not_applied().is_empty() {
                lent.warn(&format!("does not apply {}", listed(lent.clip.not_applied())));
            }
            for (names, whose) in [
                (lent.clip.repeated().to_vec(), "of that file"),
                (lent.repeated.iter().cloned().collect(), "of the model"),
            ] {
                if !names.is_empty() {
                    lent.warn(&format!(
                        "several nodes {whose} are named {}; the first one counts",
                        listed(&names)
                    ));
                }
            }
        }
    }
}

impl Lent {
    /// Remembers what a body took.
    fn take<T>(&mut self, matched: Matched<T>) -> T {
        self.matched.extend(matched.parts);
        self.repeated.extend(matched.repeated);
        matched.clip
    }

    fn no_match(&self) -> String {
        let parts: Vec<String> = self.clip.parts().collect();
        let (file, animation) = (self.file.display(), Printable(&self.animation));
        let start = format!("the animation \"{animation}\" of {file} fits no node that moves this mesh");
        match parts.len() {
            0 => format!("{start}; it animates no node that has a name"),
            _ => format!("{start}; names have to be the same, and it animates {}", listed(&parts)),
        }
    }

    fn warn(&self, what: &str) {
        let (file, animation) = (self.file.display(), Printable(&self.animation));
        messages::complain(format_args!("warning: {file}: animation \"{animation}\": {what}"));
    }
}

/// The index of an animation of a file.
fn animation(file: &Path, names: &[String], name: Option<&str>) -> Result<usize, String> {
    let file = file.display();
    let all = listed(names);
    let Some(name) = name else {
        return match names.len() {
            0 => Err(format!("{file} has no animations")),
            1 => Ok(0),
            _ => Err(format!(
                "{file} has several animations; write {file}#NAME, with one of {all}"
            )),
        };
    };
    let of_name = names.iter().position(|known| known == name);
    let index = of_name.or_else(|| name.parse().ok().filter(|&index: &usize| index < names.len()));
    index.ok_or_else(|| match names.len() {
        0 => format!("{file} has no animations"),
        _ => format!(
            "{file} has no animation \"{}\"; it has {all}{}",
            Printable(name),
            suggestion(name, names.iter().map(String::as_str))
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_split_from_the_name_unless_it_has_the_whole_name() -> std::io::Result<()> {
        let dir = tempfile::tempdir()?;
        std::fs::write(dir.path().join("a#b.glb"), "")?;
        let options = FileArgs::default();
        let files = ClipFiles::new(&options, &MemoryBudget::default(), dir.path());
        for (text, expected) in [
            ("walk", None),
            ("walk#2", None),
            ("lib.glb", Some(("lib.glb", None))),
            ("lib.glb#Walk", Some(("lib.glb", Some("Walk")))),
            ("lib.GLTF#Walk#2", Some(("lib.GLTF", Some("Walk#2")))),
            ("d#1/lib.glb#3", Some(("d#1/lib.glb", Some("3")))),
            ("a#b.glb", Some(("a#b.glb", None))),
            ("a#b.glb#c", Some(("a#b.glb", Some("c")))),
        ] {
            let expected = expected.map(|(file, name)| (dir.path().join(file), name));
            assert_eq!(files.split(text), expected, "{text}");
        }
        Ok(())
    }
}
