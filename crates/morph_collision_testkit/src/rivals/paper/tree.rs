//! The tree of a mesh (Sect. 3 and Fig. 1): built on the base, with a volume per node and reference model.

use std::ops::Range;

use glam::DVec3;

use super::references::References;
use super::split::split;
use super::volume::Volume;
use super::weights::Blend;

/// Nodes in breadth-first order, the root first.
#[derive(Clone, Debug)]
pub(super) struct Tree<V> {
    nodes: Vec<Node<V>>,
    /// The nodes' references except the base, node by node.
    references: Vec<Reference<V>>,
    /// The nodes' in-betweens, node by node.
    in_betweens: Vec<InBetween<V>>,
}

#[derive(Clone, Debug)]
struct Node<V> {
    content: Content,
    /// Around the base.
    base: V,
    references: Range<usize>,
    in_betweens: Range<usize>,
}

/// The content of a node.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Content {
    /// Child nodes, next to each other.
    Children(Range<u32>),
    /// One triangle.
    Triangle(u32),
}

/// A target that moves any vertex of a node. For all other targets the volume is that of the base.
#[derive(Clone, Debug)]
struct Reference<V> {
    target: u32,
    /// Around the reference model.
    volume: V,
    /// Around the displacements; used only for weights that are not convex.
    displacement: V,
}

/// The volume half way between reference `after` and the next, if either is not the base in this node.
#[derive(Clone, Debug)]
struct InBetween<V> {
    after: u32,
    volume: V,
}

impl<V: Volume> Tree<V> {
    /// Splits until there is one triangle in each leaf.
    pub(super) fn build(references: &References, in_betweens: bool) -> Self {
        let mut triangles: Vec<u32> = (0..references.triangles.len() as u32).collect();
        let mut tree = Self {
            nodes: Vec::new(),
            references: Vec::new(),
            in_betweens: Vec::new(),
        };
        let root = 0..triangles.len();
        let mut ranges = vec![root];
        let mut next = 0;
        while let Some(range) = ranges.get(next).cloned() {
            let of_node = &mut triangles[range.clone()];
            let vertices = vertices_of(references, of_node);
            let content = if let &mut [triangle] = of_node {
                Content::Triangle(triangle)
            } else {
                let first = ranges.len() as u32;
                let mut start = range.start;
                for count in split(references, of_node) {
                    ranges.push(start..start + count);
                    start += count;
                }
                Content::Children(first..ranges.len() as u32)
            };
            tree.push(content, references, &vertices, in_betweens);
            next += 1;
        }
        tree
    }

    fn push(&mut self, content: Content, references: &References, vertices: &[u32], in_betweens: bool) {
        let around = |position: &dyn Fn(u32) -> DVec3| {
            let points: Vec<DVec3> = vertices.iter().map(|&vertex| position(vertex)).collect();
            V::around(&points)
        };
        let (first_reference, first_in_between) = (self.references.len(), self.in_betweens.len());
        let targets = references.targets_that_move(vertices);
        self.references.extend(targets.iter().map(|&target| Reference {
            target,
            volume: around(&|vertex| references.position(vertex, target + 1)),
            displacement: around(&|vertex| references.displacement(vertex, target)),
        }));
        if in_betweens {
            let moves = |reference: u32| reference > 0 && targets.binary_search(&(reference - 1)).is_ok();
            let pairs = (0..references.target_count() as u32).filter(|&after| moves(after) || moves(after + 1));
            self.in_betweens.extend(pairs.map(|after| InBetween {
                after,
                volume: around(&|vertex| {
                    0.5 * (references.position(vertex, after) + references.position(vertex, after + 1))
                }),
            }));
        }
        self.nodes.push(Node {
            content,
            base: around(&|vertex| references.position(vertex, 0)),
            references: first_reference..self.references.len(),
            in_betweens: first_in_between..self.in_betweens.len(),
        });
    }

    pub(super) fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// The memory of its lists, including unused capacity.
    #[cfg(test)]
    pub(super) fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node<V>>()
            + self.references.capacity() * size_of::<Reference<V>>()
            + self.in_betweens.capacity() * size_of::<InBetween<V>>()
    }

    #[inline]
    pub(super) fn content(&self, node: u32) -> &Content {
        &self.nodes[node as usize].content
    }

    /// The blended volume of a node: Eq. 3 or 7, plus intervals for the part that is not convex.
    pub(super) fn blend(&self, node: u32, blend: &Blend) -> V {
        let node = &self.nodes[node as usize];
        let mut volume = V::ZERO;
        // References that are not stored here equal the base.
        let mut of_base = 1.0;
        for reference in &self.references[node.references.clone()] {
            let target = reference.target as usize;
            let (convex, rest) = (blend.convex[target], blend.rest[target]);
            if convex != 0.0 {
                volume.add(convex, &reference.volume);
                of_base -= convex;
            }
            if rest != 0.0 {
                volume.add(rest, &reference.displacement);
            }
        }
        if let Some((after, weight)) = blend.in_between {
            let of_node = &self.in_betweens[node.in_betweens.clone()];
            if let Ok(i) = of_node.binary_search_by_key(&after, |in_between| in_between.after) {
                volume.add(weight, &of_node[i].volume);
                of_base -= weight;
            }
        }
        // Rounding must not make it negative.
        volume.add(f64::max(of_base, 0.0), &node.base);
        volume.widen(blend.error);
        volume
    }
}

/// The vertices of some triangles, each once.
fn vertices_of(references: &References, triangles: &[u32]) -> Vec<u32> {
    let corners = |&triangle: &u32| references.triangles[triangle as usize];
    let mut vertices: Vec<u32> = triangles.iter().flat_map(corners).collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}
