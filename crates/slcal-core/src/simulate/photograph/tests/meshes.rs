//! The tree of boxes against all triangles, and against the closed form.

use nalgebra::{Point3, Rotation3, Vector3};

use super::{block, exact, rig, wall};
use crate::geometry::{Pose, Ray};
use crate::simulate::photograph::mesh::TriangleMesh;
use crate::simulate::{Draws, Photographer, Shape, Surface};

fn soup(n: u32) -> TriangleMesh {
    let mut draws = Draws::new(3, 0);
    let mut vertices = Vec::new();
    for _ in 0..n {
        let centre = Vector3::from_fn(|_, _| draws.between(-100.0, 100.0));
        vertices
            .extend((0..3).map(|_| Point3::from(centre + Vector3::from_fn(|_, _| draws.between(-9.0, 9.0)))));
    }
    TriangleMesh::new(vertices, (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
}

#[test]
fn the_tree_agrees_with_a_test_of_all_triangles() {
    let mesh = soup(3000);
    let single: Vec<TriangleMesh> = (0..mesh.triangles())
        .map(|i| TriangleMesh::new(mesh.vertices.clone(), vec![mesh.triangles[i]]).unwrap())
        .collect();
    let mut draws = Draws::new(4, 0);
    let mut hits = 0;
    for i in 0..300 {
        let origin = Point3::from(Vector3::from_fn(|_, _| draws.between(-150.0, 150.0)));
        let mut direction = Vector3::from_fn(|_, _| draws.normal());
        if i % 10 == 0 {
            // Rays along the sides of boxes.
            direction = Vector3::ith(i / 10 % 3, -1.0);
        }
        let ray = Ray { origin, direction };
        let limits = [0.0, f64::INFINITY];
        let all = single.iter().filter_map(|m| m.meet(&ray, limits)).map(|h| h.distance);
        let expected = all.fold(f64::INFINITY, f64::min);
        let found = mesh.meet(&ray, limits).map_or(f64::INFINITY, |h| h.distance);
        assert_eq!(found, expected);
        hits += usize::from(found.is_finite());
    }
    assert!((30..290).contains(&hits), "{hits}");
}

/// The twelve triangles of a block.
fn triangles(shape: &Shape) -> TriangleMesh {
    let Shape::Block { camera_from_block, size_mm } = shape else { panic!("another shape") };
    let corner = |i: usize| {
        let sign = |bit: usize| if i >> bit & 1 == 1 { 0.5 } else { -0.5 };
        Point3::new(sign(0) * size_mm[0], sign(1) * size_mm[1], sign(2) * size_mm[2])
    };
    let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let fans = faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect();
    TriangleMesh::new((0..8).map(corner).collect(), fans).unwrap().placed(1.0, camera_from_block).unwrap()
}

#[test]
fn a_block_of_triangles_renders_as_a_block() {
    let rig = rig(160);
    let shape = block(30.0, 1000.0, 170.0);
    let mesh = Shape::Mesh(triangles(&shape));
    let see = |shape| Photographer::new(&rig, &[Surface::object(shape), wall(1300.0)], &exact()).unwrap();
    let (a, b) = (see(shape), see(mesh));
    let mut on_it = 0;
    for (a, b) in a.truth().pixels().zip(b.truth().pixels()) {
        let (a, b) = (a.unwrap(), b.unwrap());
        assert_eq!(a.surface, b.surface);
        assert_eq!(a.panel.is_some(), b.panel.is_some());
        assert!((a.point - b.point).norm() < 1e-8);
        on_it += usize::from(a.surface == 0);
    }
    assert!(on_it > 500, "{on_it}");
}

#[test]
fn a_mesh_is_moved_scaled_and_measured() {
    let pose = Pose {
        rotation: Rotation3::from_euler_angles(0.0, 0.0, 0.0),
        translation: Vector3::new(1.0, 2.0, 3.0),
    };
    let one = TriangleMesh::new(
        vec![Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 2.0, -1.0)],
        vec![[0, 1, 2]],
    );
    let [least, most] = one.unwrap().placed(10.0, &pose).unwrap().bounds();
    assert_eq!((least, most), (Point3::new(1.0, 2.0, -7.0), Point3::new(11.0, 22.0, 3.0)));
}

#[test]
fn meshes_without_a_surface_are_refused() {
    let p = |x: f64| Point3::new(x, 0.0, 1.0);
    for (vertices, triangles) in [
        (vec![], vec![]),
        (vec![p(0.0), p(1.0), p(2.0)], vec![[0, 1, 2]]),
        (vec![p(0.0)], vec![[0, 1, 2]]),
        (vec![p(f64::NAN), p(1.0), p(2.0)], vec![[0, 1, 2]]),
    ] {
        assert!(TriangleMesh::new(vertices, triangles).is_err());
    }
}

#[test]
fn triangles_that_repeat_another_one_are_tested_once() {
    let mesh = soup(2);
    let [a, b] = [0, 1].map(|i| mesh.triangles[i]);
    let repeated = [vec![a; 1000], vec![b; 300], vec![a; 7]].concat();
    let repeated = TriangleMesh::new(mesh.vertices.clone(), repeated).unwrap();
    assert!(repeated.largest_leaf() <= 4, "{}", repeated.largest_leaf());
    for triangle in [a, b] {
        let middle = triangle.iter().map(|i| mesh.vertices[*i as usize].coords).sum::<Vector3<f64>>() / 3.0;
        let ray = Ray { origin: Point3::origin(), direction: middle };
        let [hit, expected] =
            [&repeated, &mesh].map(|m| m.meet(&ray, [0.0, f64::INFINITY]).unwrap().distance);
        assert_eq!(hit, expected);
    }
}
