//! Tables that turn the blended boxes of clusters into the boxes of a group's children under joints (docs/skinning.md).
//!
//! The boxes of a group's children are in one *frame*: the space of the joint that moves most of the group. How a joint moves points in
//! that frame is its *map*: frame from world times world from mesh. The clusters of the children are stored side by side in *blocks*.

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;

use super::blocks::{Lane, Steps, arranged, spread, steps};
use super::clusters::{Cluster, NONE, dominant};
use super::extents::NodeExtents;
use super::joint_boxes::JointBoxes;
use super::root_children::RootChildren;
use super::tables::{GroupTables, Tables};
use super::topology::Topology;
use crate::bounds::{LANES, Lanes};
use crate::model::{MorphModel, Skin};

/// The frame of the whole body, to which the boxes of all groups can be taken: the space of the joint that moves most of the mesh.
pub(crate) const BODY_FRAME: usize = 0;

/// Identifies a map: a joint, as seen in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct MapKey {
    pub(crate) frame: u16,
    pub(crate) joint: u16,
}

/// The clusters of a block with the same strongest joint, which maps them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pivot {
    pub(crate) map: u32,
    pub(crate) lanes: u8,
}

/// The kernel keeps the images under this many pivots of a block for its rows.
pub(crate) const KEPT_IMAGES: usize = 4;

/// The weight interval of a joint for each cluster of a block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub(crate) map: u32,
    /// The index of the block's pivot with the same map, if it is one of the first [`KEPT_IMAGES`]; otherwise `KEPT_IMAGES`.
    pub(crate) pivot: u8,
    pub(crate) low: Lanes,
    pub(crate) high: Lanes,
}

#[derive(Clone, Debug)]
struct BlockHeader {
    /// The child of each lane.
    children: [u8; LANES],
    lanes: u8,
    pivots: Range<u32>,
    rows: Range<u32>,
    weight: f32,
    missing: f32,
}

/// Up to eight clusters of the children of a group, side by side.
pub(crate) struct Block<'a> {
    pub(crate) tables: GroupTables<'a>,
    /// One set bit per lane that has a cluster.
    pub(crate) lanes: u8,
    /// The child of each lane.
    pub(crate) children: &'a [u8; LANES],
    /// The strongest joint of each cluster.
    pub(crate) pivots: &'a [Pivot],
    /// All other joints.
    pub(crate) rows: &'a [Row],
    /// The largest sum of absolute weights of a cluster in the rows.
    pub(crate) weight: f32,
    /// The largest difference between a sum of weights and 1 that is not in the rows.
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
    /// By block.
    boxes: Tables,
    /// The joint of each frame; `None` for the frame of groups that no joint moves.
    pub(crate) frames: Vec<Option<u16>>,
    /// All maps that any group needs.
    pub(crate) maps: Vec<MapKey>,
    /// Indices into `maps`, group by group.
    maps_of_groups: Vec<u32>,
    pub(crate) joints: JointBoxes,
    /// Set if the root's children are blended one by one. Their group has no blocks then.
    pub(crate) root_children: Option<RootChildren>,
}

impl SkinTables {
    #[inline(always)]
    pub(crate) fn frame(&self, group: usize) -> usize {
        usize::from(self.groups[group].frame)
    }

    /// The number of groups, and of the root's children if these are blended one by one.
    pub(crate) fn group_count(&self) -> usize {
        self.groups.len()
    }

    /// Whether some sums of weights in a group differ from 1, and the difference is not in its rows.
    pub(crate) fn misses_weight(&self, group: usize) -> bool {
        self.blocks(group).any(|block| self.blocks[block].missing > 0.0)
    }

    /// The indices of the maps that a group's boxes depend on.
    #[inline(always)]
    pub(crate) fn maps_of(&self, group: usize) -> &[u32] {
        let maps = &self.groups[group].maps;
        &self.maps_of_groups[maps.start as usize..maps.end as usize]
    }

    /// The numbers of a group's blocks.
    #[inline(always)]
    pub(crate) fn blocks(&self, group: usize) -> Range<usize> {
        let blocks = &self.groups[group].blocks;
        blocks.start as usize..blocks.end as usize
    }

    #[inline(always)]
    pub(crate) fn block(&self, index: usize) -> Block<'_> {
        let block = &self.blocks[index];
        Block {
            tables: self.boxes.group(index),
            lanes: block.lanes,
            children: &block.children,
            pivots: &self.pivots[block.pivots.start as usize..block.pivots.end as usize],
            rows: &self.rows[block.rows.start as usize..block.rows.end as usize],
            weight: block.weight,
            missing: block.missing,
        }
    }

    fn shrink_to_fit(&mut self) {
        self.groups.shrink_to_fit();
        self.blocks.shrink_to_fit();
        self.pivots.shrink_to_fit();
        self.rows.shrink_to_fit();
        self.frames.shrink_to_fit();
        self.maps.shrink_to_fit();
        self.maps_of_groups.shrink_to_fit();
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.groups)
            + size_of_val(&*self.blocks)
            + size_of_val(&*self.pivots)
            + size_of_val(&*self.rows)
            + self.boxes.bytes()
            + size_of_val(&*self.frames)
            + size_of_val(&*self.maps)
            + size_of_val(&*self.maps_of_groups)
            + self.joints.bytes()
            + self.root_children.as_ref().map_or(0, RootChildren::bytes)
    }
}

/// Collects the tables while a tree is built.
pub(super) struct SkinBuilder {
    tables: SkinTables,
    frames: HashMap<u16, u16>,
    maps: HashMap<MapKey, u32>,
    /// The number of the extra joint that takes every point to the world's origin.
    origin: u16,
}

impl SkinBuilder {
    /// `whole` is the joint that moves most of the mesh.
    pub(super) fn new(whole: u16, skin: &Skin) -> Self {
        let mut builder = Self {
            origin: skin.joint_count() as u16,
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

    /// Fills a group's tables from the clusters of its children. Its boxes are in the body's frame if `in_body_frame`, otherwise in the
    /// frame of the joint that moves most of the group.
    pub(super) fn fill(&mut self, group: usize, children: &[Vec<Cluster>], in_body_frame: bool) {
        let frame = if in_body_frame {
            BODY_FRAME as u16
        } else {
            self.frame(dominant(children.iter().flatten()))
        };
        let blocks = arranged(children);
        if in_body_frame && RootChildren::are_cheap(children, blocks.len()) {
            self.fill_one_by_one(group, children);
        } else {
            self.tables.groups[group] = self.header(frame, &blocks);
        }
    }

    /// Fills the tables of the root's children as if each were a group.
    fn fill_one_by_one(&mut self, group: usize, children: &[Vec<Cluster>]) {
        let first = self.tables.groups.len();
        for clusters in children {
            let header = self.header(BODY_FRAME as u16, &spread(clusters));
            self.tables.groups.push(header);
        }
        self.tables.root_children = Some(RootChildren::new(group, first, children, self.origin));
    }

    /// Adds the blocks of a group.
    fn header(&mut self, frame: u16, blocks: &[Vec<Lane<'_>>]) -> GroupHeader {
        let first_block = self.tables.blocks.len();
        for lanes in blocks {
            self.add(frame, lanes);
        }
        let blocks = &self.tables.blocks[first_block..];
        let maps = |block: &BlockHeader| {
            let pivots = &self.tables.pivots[block.pivots.start as usize..block.pivots.end as usize];
            let rows = &self.tables.rows[block.rows.start as usize..block.rows.end as usize];
            let maps = pivots
                .iter()
                .map(|pivot| pivot.map)
                .chain(rows.iter().map(|row| row.map));
            maps.collect::<Vec<_>>()
        };
        let used: BTreeSet<u32> = blocks.iter().flat_map(maps).collect();
        let first_map = self.tables.maps_of_groups.len();
        self.tables.maps_of_groups.extend(used);
        GroupHeader {
            frame,
            blocks: first_block as u32..self.tables.blocks.len() as u32,
            maps: first_map as u32..self.tables.maps_of_groups.len() as u32,
        }
    }

    /// Adds a block.
    fn add(&mut self, frame: u16, lanes: &[Lane<'_>]) {
        let mut header = BlockHeader {
            children: [0, 1, 2, 3, 4, 5, 6, 7],
            lanes: 0,
            pivots: self.tables.pivots.len() as u32..0,
            rows: self.tables.rows.len() as u32..0,
            weight: 0.0,
            missing: 0.0,
        };
        let Steps { pivots, rows } = steps(lanes);
        for (lane, &(child, cluster)) in lanes.iter().enumerate() {
            header.children[lane] = child as u8;
            let Some(cluster) = cluster else { continue };
            header.lanes |= 1 << lane;
            header.weight = header.weight.max(weight_of_others(cluster));
            header.missing = header.missing.max(cluster.missing);
        }
        for (joint, lanes) in pivots {
            let map = self.map(frame, joint);
            self.tables.pivots.push(Pivot { map, lanes });
        }
        header.pivots.end = self.tables.pivots.len() as u32;
        for (joint, [low, high]) in rows {
            let map = self.map(frame, joint);
            let pivots = &self.tables.pivots[header.pivots.start as usize..header.pivots.end as usize];
            let pivot = pivots.iter().take(KEPT_IMAGES).position(|pivot| pivot.map == map);
            self.tables.rows.push(Row {
                map,
                pivot: pivot.unwrap_or(KEPT_IMAGES) as u8,
                low,
                high,
            });
        }
        header.rows.end = self.tables.rows.len() as u32;
        // Lanes without a cluster get a point near the others, so that all numbers stay small.
        let first = lanes.iter().find_map(|(_, cluster)| *cluster);
        let extents = |(_, cluster): &Lane<'_>| match (cluster, first) {
            (Some(cluster), _) => Some(cluster.extents.clone()),
            (None, first) => first.map(|first| first.extents.a_point()),
        };
        let extents: Vec<NodeExtents> = lanes.iter().filter_map(extents).collect();
        let whole = NodeExtents::of_parts(extents.iter());
        self.tables.boxes.reserve();
        self.tables.boxes.fill(self.tables.blocks.len(), &extents, &whole);
        self.tables.blocks.push(header);
    }

    pub(super) fn finish(mut self, model: &MorphModel, topology: &Topology) -> SkinTables {
        self.tables.shrink_to_fit();
        self.tables.boxes.finish();
        self.tables.joints = JointBoxes::new(model);
        if let (Some(children), Some(skin)) = (&mut self.tables.root_children, model.skin()) {
            children.finish(model, topology, skin);
        }
        self.tables
    }
}

/// The sum of the largest absolute weights of the joints other than the strongest.
fn weight_of_others(cluster: &Cluster) -> f32 {
    let (sum, terms) = cluster.others().fold((0.0_f32, 0.0_f32), |(sum, terms), weight| {
        (sum + weight.low.abs().max(weight.high.abs()), terms + 1.0)
    });
    // The factor covers the roundings of the sum.
    sum * 1.001_f32.max(1.0 + terms * f32::EPSILON)
}
