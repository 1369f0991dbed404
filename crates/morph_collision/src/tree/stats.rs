use thiserror::Error;

use super::{ChildKind, Leaf, MorphBvh};
use crate::bounds::{BoxLanes, LANES};

/// What a tree is made of. From [`MorphBvh::stats`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BvhStats {
    /// Nodes, leaves and root included.
    pub nodes: usize,
    /// Nodes that are leaves.
    pub leaves: usize,
    /// Edges on the longest way from the root to a leaf.
    pub depth: usize,
    /// Bytes on the heap: topology and tables.
    pub bytes: usize,
    /// Of these, bytes of tables.
    pub table_bytes: usize,
    /// Children per inner node, on average.
    pub mean_children: f64,
    /// Triangles per leaf, on average.
    pub mean_leaf_triangles: f64,
    /// Targets that move something in a group of children, on average.
    pub mean_local_targets: f64,
}

/// What is broken in a tree, and where; from [`MorphBvh::validate`]. Any of it is a bug of this crate.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BrokenTree {
    /// A group has no children, or more than eight.
    #[error("group {group} has {children} children")]
    Children {
        /// The group.
        group: usize,
        /// How many children it has.
        children: usize,
    },
    /// Groups or leaves are not in preorder, or not there.
    #[error("child {lane} of group {group} is not next in preorder")]
    Order {
        /// The group.
        group: usize,
        /// The child.
        lane: usize,
    },
    /// Groups or leaves that no group leads to.
    #[error("{reached} of {there} {what} can be reached from the root")]
    Unreached {
        /// Groups or leaves.
        what: &'static str,
        /// How many can be reached.
        reached: usize,
        /// How many there are.
        there: usize,
    },
    /// A leaf has no triangles, or more than it may.
    #[error("leaf {leaf} has {triangles} triangles")]
    Leaf {
        /// The leaf.
        leaf: usize,
        /// How many triangles it has.
        triangles: usize,
    },
    /// A triangle is in no leaf, or in several.
    #[error("triangle {triangle} is in {leaves} leaves")]
    Triangle {
        /// The triangle.
        triangle: usize,
        /// In how many leaves it is.
        leaves: usize,
    },
    /// A number in a group's tables is NaN or infinite.
    #[error("the tables of group {group} hold {value}")]
    Table {
        /// The group.
        group: usize,
        /// The number.
        value: String,
    },
}

impl MorphBvh {
    /// Counts nodes and bytes; `O(n)`.
    #[must_use]
    pub fn stats(&self) -> BvhStats {
        let topology = &self.topology;
        let (nodes, leaves) = (self.node_count(), self.leaf_count());
        // Group 0 has only the root.
        let inner = (topology.group_count() - 1).max(1);
        BvhStats {
            nodes,
            leaves,
            depth: self.depth(),
            bytes: self.bytes(),
            table_bytes: self.tables.bytes(),
            mean_children: (nodes - 1) as f64 / inner as f64,
            mean_leaf_triangles: topology.triangles.len() as f64 / leaves as f64,
            mean_local_targets: self.tables.local_targets() as f64 / topology.group_count() as f64,
        }
    }

    /// Checks everything that the tree's own code relies on; `O(n)`.
    ///
    /// That boxes hold their vertices is checked for given weights by
    /// [`Pose::check_containment`](crate::Pose::check_containment).
    ///
    /// # Errors
    /// [`BrokenTree`] says what is broken first, and where.
    pub fn validate(&self) -> Result<(), BrokenTree> {
        self.validate_topology()?;
        self.validate_tables()
    }

    fn validate_topology(&self) -> Result<(), BrokenTree> {
        let mut expected = Expected {
            bvh: self,
            group: 1,
            leaf: 0,
            in_leaves: vec![0; self.model.triangle_count()],
        };
        expected.walk(0)?;
        let reached = [
            ("groups", expected.group, self.topology.group_count()),
            ("leaves", expected.leaf, self.leaf_count()),
        ];
        for (what, reached, there) in reached {
            if reached != there {
                return Err(BrokenTree::Unreached { what, reached, there });
            }
        }
        match expected.in_leaves.iter().position(|&leaves| leaves != 1) {
            Some(triangle) => Err(BrokenTree::Triangle {
                triangle,
                leaves: expected.in_leaves[triangle],
            }),
            None => Ok(()),
        }
    }

    fn validate_tables(&self) -> Result<(), BrokenTree> {
        for group in 0..self.topology.group_count() {
            let table = self.tables.group(group);
            let mut bad = None;
            let mut check = |boxes: &BoxLanes| {
                let mut numbers = boxes.rows().flat_map(|row| row.0);
                bad = bad.or_else(|| numbers.find(|x| !x.is_finite()));
            };
            check(table.base);
            table.intervals.iter().chain(table.references).for_each(&mut check);
            if let Some(value) = bad {
                let value = value.to_string();
                return Err(BrokenTree::Table { group, value });
            }
        }
        Ok(())
    }
}

/// What comes next in preorder.
struct Expected<'a> {
    bvh: &'a MorphBvh,
    group: usize,
    leaf: usize,
    in_leaves: Vec<usize>,
}

impl Expected<'_> {
    fn walk(&mut self, group: usize) -> Result<(), BrokenTree> {
        let topology = &self.bvh.topology;
        let children = topology.group(group).children();
        if children.is_empty() || children.len() > LANES {
            return Err(BrokenTree::Children {
                group,
                children: children.len(),
            });
        }
        for (lane, child) in children.iter().enumerate() {
            match child.kind() {
                ChildKind::Group(child) if child == self.group && child < topology.group_count() => {
                    self.group += 1;
                    self.walk(child)?;
                }
                ChildKind::Leaf(leaf) if leaf.0 == self.leaf && leaf.0 < self.bvh.leaf_count() => {
                    self.leaf += 1;
                    self.check_leaf(leaf)?;
                }
                _ => return Err(BrokenTree::Order { group, lane }),
            }
        }
        Ok(())
    }

    fn check_leaf(&mut self, leaf: Leaf) -> Result<(), BrokenTree> {
        let triangles = self.bvh.topology.leaf_triangles(leaf);
        if triangles.is_empty() || triangles.len() > self.bvh.options.leaf_size {
            return Err(BrokenTree::Leaf {
                leaf: leaf.0,
                triangles: triangles.len(),
            });
        }
        for &triangle in triangles {
            self.in_leaves[triangle as usize] += 1;
        }
        Ok(())
    }
}
