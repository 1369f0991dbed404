//! What takes the blended boxes of clusters to the boxes of a group's children under joints (docs/skinning.md).
//!
//! The children of a group have their boxes in one *frame*: the space of the joint that moves most of them. What a joint does there is
//! its *map*: frame from world times world from mesh. The clusters of the children stand side by side in *blocks*, one cluster of each child per block.

use std::collections::HashMap;
use std::ops::Range;

use super::clusters::{Cluster, Interval, NONE, dominant};
use super::extents::NodeExtents;
use super::tables::{GroupTables, Tables};
use crate::bounds::{LANES, Lanes};

/// The frame that all groups can be seen in: the space of the joint that moves most of the mesh.
pub(crate) const BODY_FRAME: usize = 0;

/// A joint as a frame sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct MapKey {
    pub(crate) frame: u16,
    pub(crate) joint: u16,
}

/// The clusters of a group that are mapped by the same joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pivot {
    pub(crate) map: u32,
    pub(crate) lanes: u8,
}

/// How much a joint moves each cluster of a block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub(crate) map: u32,
    pub(crate) low: Lanes,
    pub(crate) high: Lanes,
}

#[derive(Clone, Debug)]
struct BlockHeader {
    /// Where the tables of its boxes are in `more`; those of a group's first block are the group's own.
    tables: Option<u32>,
    lanes: u8,
    pivots: Range<u32>,
    rows: Range<u32>,
    weight: f32,
    missing: f32,
}

/// One cluster of each child, where a child has so many.
pub(crate) struct Block<'a> {
    pub(crate) tables: GroupTables<'a>,
    /// The children that have a cluster here.
    pub(crate) lanes: u8,
    /// The strongest joint of each cluster.
    pub(crate) pivots: &'a [Pivot],
    /// All other joints.
    pub(crate) rows: &'a [Row],
    /// The largest sum of the absolute weights in the rows of a cluster.
    pub(crate) weight: f32,
    /// How far sums of weights are from 1, if that is not among the rows.
    pub(crate) missing: f32,
}

#[derive(Clone, Debug, Default)]
struct GroupHeader {
    frame: u16,
    blocks: Range<u32>,
    maps: Range<u32>,
}

/// The tables of all groups.
#[derive(Clone, Default)]
pub(crate) struct SkinTables {
    groups: Vec<GroupHeader>,
    blocks: Vec<BlockHeader>,
    pivots: Vec<Pivot>,
    rows: Vec<Row>,
    more: Tables,
    /// The joints whose spaces are frames; `None` where no joint moves a group.
    pub(crate) frames: Vec<Option<u16>>,
    /// All maps that any group needs.
    pub(crate) maps: Vec<MapKey>,
    /// The maps of each group.
    maps_of_groups: Vec<u32>,
}

impl SkinTables {
    #[inline(always)]
    pub(crate) fn frame(&self, group: usize) -> usize {
        usize::from(self.groups[group].frame)
    }

    /// Whether the boxes of a group are kept in the body's frame because its bounds are made of them.
    pub(crate) fn is_top(&self, group: usize) -> bool {
        group <= 1
    }

    /// The maps that a group's boxes depend on.
    #[inline(always)]
    pub(crate) fn maps_of(&self, group: usize) -> &[u32] {
        let maps = &self.groups[group].maps;
        &self.maps_of_groups[maps.start as usize..maps.end as usize]
    }

    #[inline(always)]
    pub(crate) fn blocks<'a>(&'a self, tables: &'a Tables, group: usize) -> impl Iterator<Item = Block<'a>> {
        let blocks = &self.groups[group].blocks;
        self.blocks[blocks.start as usize..blocks.end as usize]
            .iter()
            .map(move |block| Block {
                tables: match block.tables {
                    None => tables.group(group),
                    Some(index) => self.more.group(index as usize),
                },
                lanes: block.lanes,
                pivots: &self.pivots[block.pivots.start as usize..block.pivots.end as usize],
                rows: &self.rows[block.rows.start as usize..block.rows.end as usize],
                weight: block.weight,
                missing: block.missing,
            })
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.groups)
            + size_of_val(&*self.blocks)
            + size_of_val(&*self.pivots)
            + size_of_val(&*self.rows)
            + self.more.bytes()
            + size_of_val(&*self.frames)
            + size_of_val(&*self.maps)
            + size_of_val(&*self.maps_of_groups)
    }
}

/// Collects the tables while a tree is built.
pub(super) struct SkinBuilder {
    tables: SkinTables,
    frames: HashMap<u16, u16>,
    maps: HashMap<MapKey, u32>,
}

impl SkinBuilder {
    pub(super) fn new(whole: u16) -> Self {
        let mut builder = Self {
            tables: SkinTables::default(),
            frames: HashMap::new(),
            maps: HashMap::new(),
        };
        builder.frame(whole);
        builder
    }

    /// The number of the frame of a joint.
    fn frame(&mut self, joint: u16) -> u16 {
        *self.frames.entry(joint).or_insert_with(|| {
            self.tables.frames.push((joint != NONE).then_some(joint));
            self.tables.frames.len() as u16 - 1
        })
    }

    fn map(&mut self, frame: u16, joint: u16) -> u32 {
        let key = MapKey { frame, joint };
        *self.maps.entry(key).or_insert_with(|| {
            self.tables.maps.push(key);
            self.tables.maps.len() as u32 - 1
        })
    }

    /// Adds the next group in preorder, to be filled later.
    pub(super) fn reserve(&mut self) {
        self.tables.groups.push(GroupHeader::default());
    }

    /// Fills a group's tables from the clusters of its children; `tables` has those of its boxes. The boxes are in the body's frame, or in that of
    /// the joint that moves most of the group.
    pub(super) fn fill(&mut self, tables: &mut Tables, group: usize, children: &[Vec<Cluster>], in_body_frame: bool) {
        let frame = if in_body_frame {
            BODY_FRAME as u16
        } else {
            self.frame(dominant(children.iter().flatten()))
        };
        let first_block = self.tables.blocks.len();
        let mut used = Vec::new();
        for block in 0..children.iter().map(Vec::len).max().unwrap_or(0) {
            let clusters: Vec<Option<&Cluster>> = children.iter().map(|clusters| clusters.get(block)).collect();
            // In place of a cluster that is not there: a point of the child, so that all numbers stay small.
            let extents: Vec<NodeExtents> = clusters
                .iter()
                .zip(children)
                .map(|(cluster, child)| match cluster {
                    Some(cluster) => cluster.extents.clone(),
                    None => child[0].extents.a_point(),
                })
                .collect();
            let whole = NodeExtents::of_parts(&extents);
            let tables = if block == 0 {
                tables.fill(group, &extents, &whole);
                None
            } else {
                self.tables.more.reserve();
                let index = self.tables.more.len() - 1;
                self.tables.more.fill(index, &extents, &whole);
                Some(index as u32)
            };
            let (pivots, rows) = (self.tables.pivots.len(), self.tables.rows.len());
            let lanes = self.add(frame, &clusters);
            let header = BlockHeader {
                tables,
                lanes,
                pivots: pivots as u32..self.tables.pivots.len() as u32,
                rows: rows as u32..self.tables.rows.len() as u32,
                weight: clusters
                    .iter()
                    .flatten()
                    .map(|cluster| weight_of_others(cluster))
                    .fold(0.0, f32::max),
                missing: clusters
                    .iter()
                    .flatten()
                    .map(|cluster| cluster.missing)
                    .fold(0.0, f32::max),
            };
            used.extend(self.tables.pivots[pivots..].iter().map(|pivot| pivot.map));
            used.extend(self.tables.rows[rows..].iter().map(|row| row.map));
            self.tables.blocks.push(header);
        }
        used.sort_unstable();
        used.dedup();
        let first_map = self.tables.maps_of_groups.len();
        self.tables.maps_of_groups.extend(used);
        self.tables.groups[group] = GroupHeader {
            frame,
            blocks: first_block as u32..self.tables.blocks.len() as u32,
            maps: first_map as u32..self.tables.maps_of_groups.len() as u32,
        };
    }

    /// Adds the pivots and rows of a block; returns the lanes that are used.
    fn add(&mut self, frame: u16, clusters: &[Option<&Cluster>]) -> u8 {
        let lanes = || {
            (0..LANES)
                .zip(clusters)
                .filter_map(|(lane, cluster)| Some((lane, (*cluster)?)))
        };
        let mut pivots: Vec<Pivot> = Vec::new();
        let mut rows: Vec<Row> = Vec::new();
        for (lane, cluster) in lanes() {
            let map = self.map(frame, cluster.strongest());
            match pivots.iter_mut().find(|pivot| pivot.map == map) {
                Some(pivot) => pivot.lanes |= 1 << lane,
                None => pivots.push(Pivot { map, lanes: 1 << lane }),
            }
            for &Interval { joint, low, high } in cluster.others() {
                let map = self.map(frame, joint);
                let place = rows.iter().position(|row| row.map == map).unwrap_or(rows.len());
                if place == rows.len() {
                    let none = Lanes::default();
                    rows.push(Row {
                        map,
                        low: none,
                        high: none,
                    });
                }
                rows[place].low.0[lane] = low;
                rows[place].high.0[lane] = high;
            }
        }
        self.tables.pivots.extend(pivots);
        self.tables.rows.extend(rows);
        lanes().fold(0, |mask, (lane, _)| mask | 1 << lane)
    }

    pub(super) fn finish(mut self) -> SkinTables {
        self.tables.more.finish();
        self.tables
    }
}

/// The sum of the largest absolute weights of the joints other than the strongest.
fn weight_of_others(cluster: &Cluster) -> f32 {
    let sum: f32 = cluster
        .others()
        .map(|weight| weight.low.abs().max(weight.high.abs()))
        .sum();
    // For the roundings of the sum, of at most a few dozen terms.
    sum * 1.001
}
