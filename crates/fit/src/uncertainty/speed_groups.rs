//! Which blocks were tested at one mean speed, and what each speed has.

use super::design::Block;
use super::speed_prior::POINTS_OF_A_SPEED;
use crate::signal::mean;
use crate::units::{SAME_SPEED, group_of, near_groups};

/// Reduced frequencies closer than this ratio are one test point, as in tables.
const SAME_POINT: f64 = 1.03;

/// Number of the speed of every block, and the speeds, rising; `None` when a block has none or all have the same.
pub(super) fn speed_groups(blocks: &[Block]) -> Option<(Vec<usize>, Vec<f64>)> {
    let speeds: Vec<f64> = blocks.iter().map(|b| b.speed_m_s).collect::<Option<_>>()?;
    let groups = near_groups(speeds.iter().copied(), SAME_SPEED);
    if groups.len() < 2 {
        return None;
    }
    Some((
        speeds.into_iter().map(|v| group_of(&groups, v)).collect(),
        groups.iter().map(|g| mean(g)).collect(),
    ))
}

/// The speed of all blocks, if they have one.
pub(super) fn only_speed(blocks: &[Block]) -> Vec<f64> {
    let speeds: Option<Vec<f64>> = blocks.iter().map(|b| b.speed_m_s).collect();
    speeds.map(|all| mean(&all)).into_iter().collect()
}

/// Reduced frequencies that the blocks of every group have; `None` when they share none or do not say.
pub(super) fn shared_range(blocks: &[Block], groups: &[usize]) -> Option<(f64, f64)> {
    let count = groups.iter().max().map_or(0, |g| g + 1);
    let mut ranges = vec![(f64::INFINITY, 0.0_f64); count];
    for (block, group) in blocks.iter().zip(groups) {
        let k = block.k?;
        let range = &mut ranges[*group];
        *range = (range.0.min(k), range.1.max(k));
    }
    let low = ranges.iter().map(|r| r.0).fold(0.0, f64::max);
    let high = ranges.iter().map(|r| r.1).fold(f64::INFINITY, f64::min);
    (low < high).then_some((low, high))
}

/// Test points at each speed: reduced frequencies that can be told apart, on average over the speeds.
pub(super) fn points_of_a_speed(blocks: &[Block], groups: &[usize], speeds: usize) -> f64 {
    let points = |group: usize| {
        let own = blocks.iter().zip(groups).filter(|(_, g)| **g == group);
        near_groups(own.filter_map(|(b, _)| b.k), SAME_POINT).len()
    };
    let sum: usize = (0..speeds).map(points).sum();
    if sum == 0 {
        // motions without a frequency of their own
        return POINTS_OF_A_SPEED;
    }
    sum as f64 / speeds as f64
}
