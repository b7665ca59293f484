//! The outlines of a part of a plane that is given as many small polygons.

use std::collections::BTreeMap;

/// A corner in hundredths, so that polygons beside each other share theirs.
type Corner = [i64; 2];

/// A corner, and whether it lies on the level that cut it off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cut {
    pub(super) at: [f64; 2],
    pub(super) on_level: bool,
}

/// Edges of polygons of one orientation without those that two of them share.
#[derive(Debug, Default)]
pub(super) struct Outline {
    /// From corner to corner, and whether the edge is a part of the level's line.
    edges: BTreeMap<(Corner, Corner), bool>,
}

impl Outline {
    pub(super) fn add(&mut self, polygon: &[Cut]) {
        let next = polygon.iter().cycle().skip(1);
        for (a, b) in polygon.iter().zip(next) {
            let (from, to) = (rounded(a.at), rounded(b.at));
            if from != to && self.edges.remove(&(to, from)).is_none() {
                self.edges.insert((from, to), a.on_level && b.on_level);
            }
        }
    }

    /// Closed lines around all polygons.
    pub(super) fn around(&self) -> Vec<Vec<[f64; 2]>> {
        chains(self.edges.keys().copied())
    }

    /// The lines of the level alone.
    pub(super) fn of_level(&self) -> Vec<Vec<[f64; 2]>> {
        chains(self.edges.iter().filter(|(_, on)| **on).map(|(edge, _)| *edge))
    }
}

fn rounded([x, y]: [f64; 2]) -> Corner {
    [x, y].map(|c| (c * 100.0).round() as i64)
}

/// Edges joined into lines that are as long as possible.
fn chains(edges: impl Iterator<Item = (Corner, Corner)>) -> Vec<Vec<[f64; 2]>> {
    let mut after: BTreeMap<Corner, Vec<Corner>> = BTreeMap::new();
    let mut arriving: BTreeMap<Corner, usize> = BTreeMap::new();
    for (from, to) in edges {
        after.entry(from).or_default().push(to);
        *arriving.entry(to).or_default() += 1;
    }
    // Open lines begin where more edges leave than arrive, and come before closed ones.
    let open = |from: &Corner, to: &[Corner]| to.len() > arriving.get(from).copied().unwrap_or(0);
    let mut starts: Vec<Corner> =
        after.iter().filter(|(from, to)| open(from, to)).map(|(from, _)| *from).collect();
    starts.extend(after.keys());
    let mut lines = Vec::new();
    for start in starts {
        while let Some(line) = walk(start, &mut after) {
            lines.push(line.into_iter().map(|c| c.map(|x| x as f64 / 100.0)).collect());
        }
    }
    lines
}

/// From a corner on, along edges that were not walked before. Corners on a straight line are left out.
fn walk(start: Corner, after: &mut BTreeMap<Corner, Vec<Corner>>) -> Option<Vec<Corner>> {
    let mut line = vec![start];
    let mut at = start;
    while let Some(next) = after.get_mut(&at).and_then(Vec::pop) {
        if let [.., before, last] = line[..]
            && straight(before, last, next)
        {
            line.pop();
        }
        line.push(next);
        at = next;
    }
    (line.len() > 1).then_some(line)
}

fn straight(a: Corner, b: Corner, c: Corner) -> bool {
    (b[0] - a[0]) * (c[1] - b[1]) == (b[1] - a[1]) * (c[0] - b[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64) -> [Cut; 4] {
        [[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]].map(|at| Cut { at, on_level: at[0] == 2.0 })
    }

    #[test]
    fn shared_edges_are_left_out() {
        let mut outline = Outline::default();
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (5.0, 5.0)] {
            outline.add(&square(x, y));
        }
        let around = outline.around();
        assert_eq!(around.len(), 2);
        assert_eq!(around[0], [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.0, 0.0]]);
        assert_eq!(outline.of_level(), [[[2.0, 0.0], [2.0, 2.0]]]);
    }
}
