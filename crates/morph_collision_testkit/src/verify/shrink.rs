//! Shrinks a wrong answer until a person can look at it.

use glam::{Affine3A, DVec3};

use super::judge::differences;
use super::{AnswerSource, Meshes, Situation, Trouble};
use morph_collision_models::mesh::MeshSkin;

/// A wrong answer, made as small as possible, with everything needed to reproduce it.
#[derive(Clone, Debug, PartialEq)]
pub struct Reproduction {
    /// The error in the answer.
    pub trouble: Trouble,
    /// Weights and placements that cause it.
    pub situation: Situation,
    /// The corners of the two triangles in world space; `None` if a vertex is outside a box.
    pub world: Option<[[DVec3; 3]; 2]>,
}

impl Reproduction {
    /// Its complexity: the number of nonzero weights, and of entries of placements and joints that differ from the identity's.
    #[must_use]
    pub fn size(&self) -> usize {
        let identity = Affine3A::IDENTITY.to_cols_array();
        let weights = self
            .situation
            .weights
            .iter()
            .flatten()
            .filter(|weight| **weight != 0.0)
            .count();
        let odd = |place: &Affine3A| {
            place
                .to_cols_array()
                .iter()
                .zip(identity)
                .filter(|(x, y)| **x != *y)
                .count()
        };
        let matrices = self
            .situation
            .places
            .iter()
            .chain(self.situation.joints.iter().flatten());
        weights + matrices.map(odd).sum::<usize>()
    }
}

/// Sets weights to zero, and joints and entries of placements to the identity's, one after another, as long as the same kind of
/// error remains.
pub fn shrink(
    meshes: Meshes<'_>,
    source: &mut impl AnswerSource,
    situation: &Situation,
    mut trouble: Trouble,
) -> Reproduction {
    let mut smallest = situation.clone();
    loop {
        let before = smallest.clone();
        for simpler in steps(meshes) {
            let mut tried = smallest.clone();
            simpler.take(&mut tried);
            if tried != smallest
                && let Some(found) = still(meshes, source, &tried, trouble)
            {
                (smallest, trouble) = (tried, found);
            }
        }
        if smallest == before {
            break;
        }
    }
    let world = match trouble {
        Trouble::Missed(a, b) | Trouble::Spurious(a, b) => Some([
            smallest.world_triangle(meshes, 0, a),
            smallest.world_triangle(meshes, 1, b),
        ]),
        Trouble::Outside { .. } => None,
    };
    Reproduction {
        trouble,
        situation: smallest,
        world,
    }
}

/// One simplification.
enum Step {
    Weight { body: usize, target: usize },
    Joint { body: usize, joint: usize },
    Place { body: usize },
    Entry { body: usize, entry: usize },
}

fn steps(meshes: Meshes<'_>) -> impl Iterator<Item = Step> {
    (0..2).flat_map(move |body| {
        let weights = (0..meshes[body].targets.len()).map(move |target| Step::Weight { body, target });
        let entries = (0..12).map(move |entry| Step::Entry { body, entry });
        let count = meshes[body].skin.as_ref().map_or(0, MeshSkin::joint_count);
        let joints = (0..count).map(move |joint| Step::Joint { body, joint });
        weights
            .chain(joints)
            .chain(std::iter::once(Step::Place { body }))
            .chain(entries)
    })
}

impl Step {
    fn take(&self, situation: &mut Situation) {
        match *self {
            Self::Weight { body, target } => situation.weights[body][target] = 0.0,
            Self::Joint { body, joint } => {
                if let Some(joint) = situation.joints[body].get_mut(joint) {
                    *joint = Affine3A::IDENTITY;
                }
            }
            Self::Place { body } => situation.places[body] = Affine3A::IDENTITY,
            Self::Entry { body, entry } => {
                let mut entries = situation.places[body].to_cols_array();
                entries[entry] = Affine3A::IDENTITY.to_cols_array()[entry];
                situation.places[body] = Affine3A::from_cols_array(&entries);
            }
        }
    }
}

/// The same error in another situation, or the same kind with other triangles; `None` if there is none.
fn still(
    meshes: Meshes<'_>,
    source: &mut impl AnswerSource,
    situation: &Situation,
    trouble: Trouble,
) -> Option<Trouble> {
    source.set(situation).ok()?;
    if let Trouble::Outside { body, .. } = trouble {
        let vertex = source.containment(body).first?.vertex;
        return Some(Trouble::Outside { body, vertex });
    }
    let answer = source.answer().pairs;
    let times = |pair| answer.iter().filter(|answered| **answered == pair).count();
    let of_pair = match trouble {
        Trouble::Missed(a, b) => times((a, b)) == 0 && situation.truth_of(meshes, (a, b)),
        Trouble::Spurious(a, b) => times((a, b)) > usize::from(situation.truth_of(meshes, (a, b))),
        Trouble::Outside { .. } => false,
    };
    if of_pair {
        return Some(trouble);
    }
    let (missed, spurious) = differences(&situation.truth(meshes), &answer);
    match trouble {
        Trouble::Missed(..) => missed.first().map(|&(a, b)| Trouble::Missed(a, b)),
        _ => spurious.first().map(|&(a, b)| Trouble::Spurious(a, b)),
    }
}
