//! The names of morph targets, which glTF itself does not have.

use serde::Deserialize;
use serde_json::value::RawValue;

use super::GltfFile;
use super::document::Mesh;

/// What exporters store beside a mesh or a primitive. Entries of any type are accepted, so that one bad name does not lose the others.
#[derive(Deserialize)]
struct Extras<'a> {
    #[serde(borrow, rename = "targetNames")]
    target_names: Vec<&'a RawValue>,
}

/// The names of `count` targets. The name of each is the first of these:
///
/// - in `targetNames` of the mesh's extras, as most exporters store it;
/// - in `targetNames` of the extras of the first primitive that has any;
/// - if neither has a name for any target, the name of its `POSITION` accessor in the first primitive, provided that all
///   targets have one there and no two are equal;
/// - `target_` and its number.
pub(super) fn read(file: &GltfFile, mesh: &Mesh, count: usize) -> Vec<String> {
    let of_mesh = of_extras(mesh.extras.as_deref());
    let mut of_primitives = mesh
        .primitives
        .iter()
        .map(|primitive| of_extras(primitive.extras.as_deref()));
    let of_primitive = of_primitives.find(|names| !names.is_empty()).unwrap_or_default();
    let mut names: Vec<Option<String>> = (0..count)
        .map(|target| {
            let name = |names: &[Option<String>]| names.get(target).cloned().flatten();
            name(&of_mesh).or_else(|| name(&of_primitive))
        })
        .collect();
    if names.iter().all(Option::is_none) {
        names = of_accessors(file, mesh).unwrap_or_default();
        names.resize(count, None);
    }
    let or_default = |(target, name): (usize, Option<String>)| name.unwrap_or_else(|| format!("target_{target}"));
    names.into_iter().enumerate().map(or_default).collect()
}

/// The names in some extras. Empty if there are none.
fn of_extras(extras: Option<&RawValue>) -> Vec<Option<String>> {
    let extras = extras.and_then(|extras| serde_json::from_str::<Extras<'_>>(extras.get()).ok());
    let names = extras.map(|extras| extras.target_names).unwrap_or_default();
    let names: Vec<Option<String>> = names.iter().map(|name| serde_json::from_str(name.get()).ok()).collect();
    if names.iter().all(Option::is_none) {
        return Vec::new();
    }
    names
}

/// The names of the accessors of the first primitive's targets, if they tell the targets apart.
fn of_accessors(file: &GltfFile, mesh: &Mesh) -> Option<Vec<Option<String>>> {
    let targets = &mesh.primitives.first()?.targets;
    let mut names = Vec::new();
    for target in targets {
        let accessor = file.root.accessors.get(target.positions?, &file.budget).ok()?;
        names.push(accessor.name.as_deref().filter(|name| !name.is_empty())?);
    }
    let mut sorted = names.clone();
    sorted.sort_unstable();
    sorted.dedup();
    (sorted.len() == names.len()).then(|| names.into_iter().map(|name| Some(name.to_owned())).collect())
}
