//! Linear interpolation between the nodes of grids over the cube [-1, 1]^3.

/// A place between two nodes of an axis: the lower one, and how far beyond it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Between {
    pub node: usize,
    pub beyond: f32,
}

/// Where a coordinate lies among `nodes` nodes, at least 2, of which the first is at -1 and the last at
/// 1. Outside it is the nearest end.
#[inline]
pub fn between(at: f32, nodes: usize) -> Between {
    let place = ((at + 1.0) * 0.5 * (nodes - 1) as f32).clamp(0.0, (nodes - 1) as f32);
    let node = (place as usize).min(nodes - 2);
    Between { node, beyond: place - node as f32 }
}

/// Four nodes of a plane around a place, and their weights; shape (v, u).
#[inline]
pub fn square(u: f32, v: f32, nodes: usize) -> [(usize, f32); 4] {
    let (u, v) = (between(u, nodes), between(v, nodes));
    let low = v.node * nodes + u.node;
    let (right, up) = (u.beyond, v.beyond);
    [
        (low, (1.0 - right) * (1.0 - up)),
        (low + 1, right * (1.0 - up)),
        (low + nodes, (1.0 - right) * up),
        (low + nodes + 1, right * up),
    ]
}

/// Eight nodes of a cube around a place, and their weights; shape (z, y, x).
#[inline]
pub fn cube([x, y, z]: [f32; 3], nodes: usize) -> [(usize, f32); 8] {
    let of_layer = square(x, y, nodes);
    let z = between(z, nodes);
    let layer = nodes * nodes;
    std::array::from_fn(|corner| {
        let (node, weight) = of_layer[corner % 4];
        let (above, share) =
            if corner < 4 { (z.node, 1.0 - z.beyond) } else { (z.node + 1, z.beyond) };
        (above * layer + node, weight * share)
    })
}

/// The coordinate of a node.
pub fn coordinate(node: usize, nodes: usize) -> f32 {
    node as f32 / (nodes - 1) as f32 * 2.0 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_linear_is_interpolated_exactly() {
        let nodes = 5;
        let value = |i: usize| {
            let at = |i: usize| coordinate(i % nodes, nodes);
            2.0 * at(i) - at(i / nodes) + 0.5 * at(i / nodes / nodes) + 3.0
        };
        for point in [[0.3, -0.7, 0.11], [-1.0, 1.0, 0.0], [1.0, 1.0, 1.0]] {
            let found: f32 = cube(point, nodes).iter().map(|&(i, weight)| weight * value(i)).sum();
            let [x, y, z] = point;
            assert!((found - (2.0 * x - y + 0.5 * z + 3.0)).abs() < 1e-5, "{point:?}: {found}");
        }
        assert_eq!(between(-1.5, 4), Between { node: 0, beyond: 0.0 });
        assert_eq!(between(1.5, 4), Between { node: 2, beyond: 1.0 });
    }
}
