//! The tree of obvhs, and the way through it.

use glam::DVec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2Node;
use obvhs::ploc::{PlocSearchDistance, SortPrecision};

use super::line::{Box3, Line};
use crate::accel::AccelError;

/// A tree of boxes.
pub(super) struct Tree {
    nodes: Vec<Bvh2Node>,
}

impl std::fmt::Debug for Tree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Tree")
            .field("nodes", &self.nodes.len())
            .finish()
    }
}

impl Tree {
    /// Builds the tree over boxes, whose leaves are their numbers.
    ///
    /// # Errors
    /// When they are more than 32-bit numbers can tell apart.
    pub(super) fn build(boxes: &[Box3]) -> Result<Self, AccelError> {
        // A tree has nearly twice as many nodes as leaves.
        let too_many = || AccelError::TooMany(boxes.len());
        let count = u32::try_from(boxes.len()).map_err(|_| too_many())?;
        count.checked_mul(2).ok_or_else(too_many)?;
        let boxes: Vec<Aabb> = boxes.iter().map(rounded).collect();
        let indices = (0..count).collect();
        let built = PlocSearchDistance::Medium.build(&boxes, indices, SortPrecision::U64, 0);
        Ok(Self { nodes: built.nodes })
    }

    /// Size of its nodes.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }

    /// The box around everything.
    pub(super) fn bounds(&self) -> Option<Box3> {
        let root = self.nodes.first()?;
        Some(box_of(root))
    }

    /// Visits the boxes that a line crosses before `limit`, the nearer ones first where the tree can
    /// tell, until a visit says that it is enough; returns whether one did.
    ///
    /// - `visit`: is given the box's number, and the limit, which it may lower.
    pub(super) fn walk(
        &self,
        line: &Line,
        limit: &mut f64,
        mut visit: impl FnMut(u32, &mut f64) -> bool,
    ) -> bool {
        let enters = |index: u32, limit: f64| {
            let node = self.nodes.get(index as usize)?;
            let Box3 { low, high } = box_of(node);
            line.enters(low, high, limit)
        };
        let mut waiting = Vec::new();
        waiting.extend(enters(0, *limit).map(|enter| (0, enter)));
        while let Some((index, enter)) = waiting.pop() {
            if enter > *limit {
                continue;
            }
            let node = &self.nodes[index as usize];
            let first = node.first_index;
            if node.is_leaf() {
                if visit(first, limit) {
                    return true;
                }
                continue;
            }
            let children = [first, first + 1].map(|child| (child, enters(child, *limit)));
            let mut met: [Option<(u32, f64)>; 2] =
                children.map(|(child, enter)| Some((child, enter?)));
            if met[0].is_some_and(|(_, a)| met[1].is_some_and(|(_, b)| a < b)) {
                met.swap(0, 1);
            }
            waiting.extend(met.into_iter().flatten());
        }
        false
    }
}

/// A box in single precision, rounded outwards.
fn rounded(bounds: &Box3) -> Aabb {
    let outwards = |value: f64, side: f64| {
        let nearest = value as f32;
        if (f64::from(nearest) - value) * side >= 0.0 {
            nearest
        } else {
            // One step and a little more; a step around zero is that of the smallest normal number.
            let step = (f64::from(nearest).abs() * 1.2e-7).max(f64::from(f32::MIN_POSITIVE));
            (f64::from(nearest) + side * step) as f32
        }
    };
    let corner = |corner: DVec3, side: f64| corner.to_array().map(|value| outwards(value, side));
    Aabb {
        min: corner(bounds.low, -1.0).into(),
        max: corner(bounds.high, 1.0).into(),
    }
}

fn box_of(node: &Bvh2Node) -> Box3 {
    let corner = |[x, y, z]: [f32; 3]| DVec3::new(x.into(), y.into(), z.into());
    Box3 {
        low: corner(node.aabb.min.to_array()),
        high: corner(node.aabb.max.to_array()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_rounded_outwards() {
        let low = DVec3::new(1.0 + 1e-9, -1.0 - 1e-9, 1e-300);
        let high = DVec3::new(1.0 + 3e-9, -1.0 + 1e-9, 2e-300);
        let found = rounded(&Box3 { low, high });
        let wide = |corner: [f32; 3]| DVec3::from_array(corner.map(f64::from));
        let (found_low, found_high) = (wide(found.min.to_array()), wide(found.max.to_array()));
        assert!(found_low.cmple(low).all() && found_high.cmpge(high).all());
        assert!((found_high - found_low).max_element() < 3e-7);
        let exact = DVec3::new(0.5, 2.0, -3.0);
        let same = rounded(&Box3 {
            low: exact,
            high: exact,
        });
        assert_eq!(wide(same.min.to_array()), exact);
        assert_eq!(wide(same.max.to_array()), exact);
    }
}
