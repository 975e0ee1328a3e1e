//! A tree of disks with eight children per node.
//!
//! Disks are sorted along a Morton curve (G. M. Morton, *A Computer Oriented Geodetic Data Base*, 1966), and
//! eight neighbors make a node, level by level. All blocks lie in one list, from the root down, and those of
//! a level along the curve. The eight of a block lie side by side, number by number.
//!
//! Blocks hold `f32`, in a frame around the middle of the disks whose unit is a power of two near their
//! extent. An `f32` point moves in it by at most 2⁻²⁵ of the extent, and no square leaves the range of `f32`.

use std::f32::consts::PI;

use glam::DVec3;
use multiversion::multiversion;

use super::super::Receiver;
use super::wide;

/// A flat disk that hides what is behind it from those whom it faces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disk {
    pub(super) center: DVec3,
    /// Of length 1.
    pub(super) normal: DVec3,
    pub(super) area: f64,
}

/// What a receiver sees of all disks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Seen {
    /// The sum of their form factors.
    pub(super) hidden: f64,
    /// The sum of the directions to them, by their form factors.
    pub(super) towards: DVec3,
}

const WIDTH: usize = 8;

type Lanes = [f32; WIDTH];

/// Eight children of a node. Those that are missing have no area.
#[derive(Clone, Debug, Default)]
struct Block {
    center: [Lanes; 3],
    radius: Lanes,
    area: Lanes,
    normal: [Lanes; 3],
    square: [Lanes; 6],
    /// The block of the first child; those of the others follow. Disks have none.
    children: Option<u32>,
}

/// Levels of 2³² disks, eight to a node.
const LEVELS: usize = 11;

/// Each level leaves at most seven blocks for later while one is looked into.
const STACK: usize = WIDTH * LEVELS;

#[derive(Clone, Debug)]
pub(super) struct Tree {
    /// The disks along the curve, and the index of each in the list that they came from.
    disks: Vec<(Disk, u32)>,
    frame: Frame,
    /// The root first, the disks last.
    blocks: Vec<Block>,
}

/// Where the blocks have their origin, and one over their unit, a power of two.
#[derive(Clone, Copy, Debug)]
struct Frame {
    middle: DVec3,
    scale: f64,
}

impl Frame {
    fn around(disks: &[Disk]) -> Self {
        let low = disks.iter().fold(DVec3::INFINITY, |low, disk| low.min(disk.center));
        let high = disks.iter().fold(DVec3::NEG_INFINITY, |high, disk| high.max(disk.center));
        // One disk has no extent but that of its area.
        let area = disks.iter().fold(0.0_f64, |most, disk| most.max(disk.area));
        let extent = (high - low).max_element().max(area.sqrt());
        // Extents of `f32` points lie between 2⁻¹⁴⁹ and 2¹²⁹: no square of the scale leaves the range of
        // `f64`.
        let is_usual = extent > 0.0 && extent.is_finite();
        let scale = if is_usual { (-extent.log2().ceil()).exp2() } else { 1.0 };
        Self { middle: if disks.is_empty() { DVec3::ZERO } else { 0.5 * (low + high) }, scale }
    }

    fn place(self, p: DVec3) -> [f32; 3] {
        ((p - self.middle) * self.scale).to_array().map(|x| x as f32)
    }
}

impl Tree {
    /// Every disk counts as it is.
    pub(super) fn over(disks: &[Disk]) -> Self {
        let (curve, frame) = (Curve::around(disks), Frame::around(disks));
        let mut order: Vec<(u64, u32)> =
            disks.iter().zip(0..).map(|(disk, index)| (curve.place(disk.center), index)).collect();
        order.sort_unstable();
        let disks: Vec<(Disk, u32)> =
            order.into_iter().map(|(_, index)| (disks[index as usize], index)).collect();
        let count = disks.len();
        let mut tree = Self { disks, frame, blocks: Vec::new() };
        tree.weigh(&vec![1.0; count]);
        tree
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.disks) + size_of_val(&*self.blocks)
    }

    /// Lets each disk count by its weight, in the order of the list that the tree was made from.
    pub(super) fn weigh(&mut self, weights: &[f64]) {
        let frame = self.frame;
        let leaf = |&(disk, index): &(Disk, u32)| Node::of(disk, weights[index as usize], frame);
        // By area alone, for the centers.
        let mut bulk: Vec<f64> = self.disks.iter().map(|(disk, _)| disk.area).collect();
        let mut nodes: Vec<Node> = self.disks.iter().map(leaf).collect();
        let mut levels: Vec<Vec<Block>> = Vec::new();
        loop {
            levels.push(nodes.chunks(WIDTH).map(Block::of).collect());
            if nodes.len() <= WIDTH {
                break;
            }
            nodes = nodes
                .chunks(WIDTH)
                .zip(bulk.chunks(WIDTH))
                .map(|(nodes, bulk)| Node::around(nodes, bulk))
                .collect();
            bulk = bulk.chunks(WIDTH).map(|bulk| bulk.iter().sum()).collect();
        }
        self.blocks.clear();
        while let Some(mut level) = levels.pop() {
            if !levels.is_empty() {
                let below = self.blocks.len() + level.len();
                for (number, block) in level.iter_mut().enumerate() {
                    block.children = Some((below + WIDTH * number) as u32);
                }
            }
            self.blocks.append(&mut level);
        }
    }

    /// Adds up form factors over the point and the normal of each receiver; without a normal, shares of all
    /// directions.
    ///
    /// A node whose radius is at most `theta` of its distance counts as one disk. It holds centers only, so
    /// one whose centers are all below the horizon hides nothing.
    pub(super) fn sums(&self, receivers: &mut dyn Iterator<Item = Receiver>, theta: f64, found: &mut [Seen]) {
        sums(self, receivers, theta as f32, found);
    }

    #[cfg(test)]
    pub(super) fn sum(&self, p: DVec3, normal: Option<DVec3>, theta: f64) -> Seen {
        self.walk(self.frame.place(p), normal.map(|normal| normal.to_array().map(|x| x as f32)), theta as f32)
    }

    #[inline(always)]
    fn walk(&self, p: [f32; 3], normal: Option<[f32; 3]>, theta: f32) -> Seen {
        let mut sums = [[0.0; WIDTH]; 4];
        let (mut stack, mut waiting) = ([0_u32; STACK], 0);
        let mut next = if self.blocks.is_empty() { None } else { Some(0) };
        while let Some(number) = next {
            let block = &self.blocks[number as usize];
            let near = block.add(p, normal, theta, &mut sums);
            if let Some(children) = block.children {
                let mut near = near;
                while near != 0 {
                    stack[waiting] = children + near.trailing_zeros();
                    waiting += 1;
                    near &= near - 1;
                }
            }
            next = waiting.checked_sub(1).map(|top| stack[top]);
            waiting = waiting.saturating_sub(1);
        }
        let [hidden, x, y, z] = sums.map(|lanes| lanes.iter().map(|&lane| f64::from(lane)).sum());
        Seen { hidden, towards: DVec3::new(x, y, z) }
    }
}

/// The sums of one run, with AVX2 instructions where the processor has them. Products and sums are rounded
/// one by one on all processors, so that all find the same bits.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt"))]
fn sums(tree: &Tree, receivers: &mut dyn Iterator<Item = Receiver>, theta: f32, found: &mut [Seen]) {
    for (receiver, found) in receivers.zip(found) {
        *found = tree.walk(tree.frame.place(wide(receiver.point)), receiver.normal, theta);
    }
}

/// A disk, or those below a node as one.
#[derive(Clone, Copy, Debug, Default)]
struct Node {
    /// The mean of the disks' centers by area, rounded to `f32`. It does not depend on the weights.
    center: DVec3,
    /// All centers of disks lie within this distance of the center.
    radius: f64,
    /// Σ w·a over the disks, with w their weights and a their areas.
    area: f64,
    /// Σ w·a·n, with n their normals.
    normal: DVec3,
    /// Σ w·a·n·nᵀ: xx, yy, zz, xy, yz, zx.
    square: [f64; 6],
}

impl Node {
    fn of(Disk { center, normal, area }: Disk, weight: f64, frame: Frame) -> Self {
        let (area, DVec3 { x, y, z }) = (weight * area * frame.scale * frame.scale, normal);
        let square = [x * x, y * y, z * z, x * y, y * z, z * x].map(|product| area * product);
        Self { center: wide(frame.place(center)), radius: 0.0, area, normal: area * normal, square }
    }

    fn around(nodes: &[Self], bulk: &[f64]) -> Self {
        let whole: f64 = bulk.iter().sum();
        let center: DVec3 = nodes.iter().zip(bulk).map(|(node, bulk)| (bulk / whole) * node.center).sum();
        let center = wide(center.to_array().map(|x| x as f32));
        let mut all = Self { center, ..Self::default() };
        for node in nodes {
            all.radius = all.radius.max(node.center.distance(center) + node.radius);
            all.area += node.area;
            all.normal += node.normal;
            for (sum, square) in all.square.iter_mut().zip(node.square) {
                *sum += square;
            }
        }
        all
    }
}

impl Block {
    fn of(nodes: &[Node]) -> Self {
        let lanes = |number: &dyn Fn(&Node) -> f64| {
            std::array::from_fn(|lane| nodes.get(lane).map_or(0.0, number) as f32)
        };
        Self {
            center: std::array::from_fn(|axis| lanes(&|node| node.center[axis])),
            radius: lanes(&|node| node.radius),
            area: lanes(&|node| node.area),
            normal: std::array::from_fn(|axis| lanes(&|node| node.normal[axis])),
            square: std::array::from_fn(|entry| lanes(&|node| node.square[entry])),
            children: None,
        }
    }

    /// Adds the form factors of the disks, or of nodes taken as one disk, to sums by lane, and those times
    /// the direction: A·cosE·cosR / (πr² + A), exact for a disk that faces the receiver straight on, and
    /// never above 1. Returns which children have to be looked into, a bit each.
    ///
    /// A·cosE of many disks is the area of their fronts as the receiver sees it: half of Σ a·|cos| + Σ a·cos.
    /// The first sum is not known. By Cauchy and Schwarz it is at most √(Σ a · Σ a·cos²), which stands for
    /// it.
    ///
    /// All eight are worked out without branches, several by each instruction.
    #[inline(always)]
    fn add(&self, p: [f32; 3], normal: Option<[f32; 3]>, theta: f32, sums: &mut [Lanes; 4]) -> u32 {
        let nodes = if self.children.is_some() { 1.0 } else { 0.0 };
        let (share, share_area) = if normal.is_some() { (1.0, 1.0) } else { (0.25, 0.5) };
        let flat = if normal.is_some() { 0.0 } else { 1.0 };
        let [up_x, up_y, up_z] = normal.unwrap_or_default();
        let [center_x, center_y, center_z] = &self.center;
        let [nx, ny, nz] = &self.normal;
        let [xx, yy, zz, xy, yz, zx] = &self.square;
        let mut near = [0_u32; WIDTH];
        for i in 0..WIDTH {
            let (x, y, z) = (center_x[i] - p[0], center_y[i] - p[1], center_z[i] - p[2]);
            let (radius, area) = (self.radius[i], self.area[i]);
            let squared = x * x + y * y + z * z;
            let distance = squared.sqrt();
            let height = up_x * x + up_y * y + up_z * z + flat * distance;
            let above = (height > -radius) & (area > 0.0);
            let is_near = above & (nodes * radius > theta * distance);
            near[i] = u32::from(is_near) << i;
            // At no distance, or at one whose square is not finite, nothing is hidden.
            let counts = above & !is_near & (squared > 0.0) & (squared < f32::INFINITY);
            let per = 1.0 / distance;
            let (x, y, z) = (x * per, y * per, z * per);
            let facing = -(x * nx[i] + y * ny[i] + z * nz[i]);
            let square = x * x * xx[i]
                + y * y * yy[i]
                + z * z * zz[i]
                + 2.0 * (x * y * xy[i] + y * z * yz[i] + z * x * zx[i]);
            // A lone disk has no such second side.
            let both = nodes * (area * square.abs()).sqrt();
            let front = 0.5 * (larger(facing.abs(), both) + facing);
            let cosine = larger(height * per, 0.0) * share;
            let hidden = front * cosine / (PI * squared + share_area * area);
            sums[0][i] += if counts { hidden } else { 0.0 };
            sums[1][i] += if counts { hidden * x } else { 0.0 };
            sums[2][i] += if counts { hidden * y } else { 0.0 };
            sums[3][i] += if counts { hidden * z } else { 0.0 };
        }
        near.iter().fold(0, |all, near| all | near)
    }
}

/// As `f32::max`, in one instruction: it need not tell what is not a number.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Morton curve through the box of some disks, 2²¹ cells along each axis.
struct Curve {
    low: DVec3,
    scale: DVec3,
}

impl Curve {
    fn around(disks: &[Disk]) -> Self {
        let low = disks.iter().fold(DVec3::INFINITY, |low, disk| low.min(disk.center));
        let high = disks.iter().fold(DVec3::NEG_INFINITY, |high, disk| high.max(disk.center));
        // Any order is right, and this one is fast. Casts of what is not a number give 0.
        Self { low, scale: DVec3::splat(f64::from((1 << 21) - 1)) / (high - low) }
    }

    fn place(&self, center: DVec3) -> u64 {
        let at = (center - self.low) * self.scale;
        spread(at.x as u64) | spread(at.y as u64) << 1 | spread(at.z as u64) << 2
    }
}

/// The 21 lowest bits of `x`, with two zeros before each.
fn spread(x: u64) -> u64 {
    let mut x = x & 0x1f_ffff;
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}
