//! Triangles are numbered as in their meshes, although the tree that is searched has other numbers: it lacks some of them, and it may have those
//! of several meshes.

use serde::{Deserialize, Serialize};

/// A mesh whose triangles are in the tree, one member after the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Member {
    /// Its index in its file.
    pub(super) mesh: usize,
    pub(super) name: String,
    /// The node that shows it.
    pub(super) node: Option<usize>,
    /// For each of its targets, the target of the tree.
    pub(super) targets: Vec<usize>,
    pub(super) target_names: Vec<String>,
    /// The number of its first triangle in the tree.
    pub(super) first: u32,
    /// The former numbers of its triangles, ascending, if some are left out.
    pub(super) kept: Option<Vec<u32>>,
}

/// Triangles of one mesh.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct MeshTriangles {
    pub(super) mesh: usize,
    pub(super) name: String,
    /// The node that shows it, if it is one of several meshes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) node: Option<usize>,
    /// Ascending.
    pub(super) triangles: Vec<u32>,
}

/// The meshes that some triangles of the tree belong to, with their numbers there. `triangles` must ascend.
pub(super) fn by_mesh(members: &[Member], triangles: &[u32]) -> Vec<MeshTriangles> {
    let mut found = Vec::new();
    let is_one_of_several = members.len() > 1;
    let (mut rest, mut members) = (triangles, members.iter().peekable());
    while let Some(member) = members.next() {
        let end = members.peek().map_or(rest.len(), |next| {
            rest.partition_point(|&triangle| triangle < next.first)
        });
        let (own, others) = rest.split_at(end);
        let number = |triangle: &u32| {
            let place = triangle - member.first;
            match &member.kept {
                Some(kept) => kept.get(place as usize).copied().unwrap_or(place),
                None => place,
            }
        };
        if !own.is_empty() {
            found.push(MeshTriangles {
                mesh: member.mesh,
                name: member.name.clone(),
                node: member.node.filter(|_| is_one_of_several),
                triangles: own.iter().map(number).collect(),
            });
        }
        rest = others;
    }
    found
}

/// The member that a triangle of the tree belongs to.
pub(super) fn member_of(members: &[Member], triangle: u32) -> Option<&Member> {
    let behind = members.partition_point(|member| member.first <= triangle);
    members.get(behind.checked_sub(1)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_get_the_numbers_of_their_meshes() {
        let member = |mesh, first, kept: Option<&[u32]>| Member {
            mesh,
            name: format!("mesh {mesh}"),
            node: Some(mesh + 10),
            targets: Vec::new(),
            target_names: Vec::new(),
            first,
            kept: kept.map(<[u32]>::to_vec),
        };
        let members = [member(4, 0, Some(&[1, 5, 9])), member(2, 3, None), member(7, 8, None)];
        let found = by_mesh(&members, &[0, 2, 8, 9]);
        let numbers: Vec<(usize, &[u32])> = found.iter().map(|found| (found.mesh, &*found.triangles)).collect();
        assert_eq!(numbers, [(4, &[1, 9][..]), (7, &[0, 1])]);
        assert!(by_mesh(&members, &[]).is_empty());
        let mesh_of = |triangle| member_of(&members, triangle).map(|member| member.mesh);
        assert_eq!([0, 2, 3, 7, 8, 99].map(mesh_of), [4, 4, 2, 2, 7, 7].map(Some));
    }
}
