//! Files with every field and with only some of them: what was read is written, every number bit for bit.

use nalgebra::{Point2, Point3};
use proptest::option::of;
use proptest::prelude::*;
use proptest::sample::select;
use serde_json::{Value, json};
use slcal_core::format::{
    ExchangeFormat, ExportConfig, ImportConfig, NamedBytes, export_rig, import_rig, read_observations,
    read_ply, read_rig, write_observations, write_ply, write_rig,
};
use slcal_core::{CloudPoint, Frame, PointCloud, Rig};

use crate::geometry::pose;

/// Finite numbers of any size.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-1e4..1e4, proptest::num::f64::NORMAL.prop_map(|x| x.clamp(-1e100, 1e100))]
}

fn sigma() -> impl Strategy<Value = f64> {
    1e-6..1e3
}

fn rows(r: &nalgebra::Matrix3<f64>) -> Value {
    json!(r.row_iter().map(|row| row.iter().copied().collect::<Vec<_>>()).collect::<Vec<_>>())
}

fn device() -> impl Strategy<Value = Value> {
    let sizes = [1_u32..5000, 1_u32..5000];
    let k = (10.0..1e4, 10.0..1e4, -1.0..1.0, number(), number());
    let distortion = [-0.3..0.3, -0.3..0.3, -0.01..0.01, -0.01..0.01, -0.1..0.1];
    let sigma = of((sigma(), sigma(), sigma(), [sigma(), sigma(), sigma(), sigma(), sigma()]));
    (sizes, k, distortion, sigma).prop_map(|([width, height], (fx, fy, s, cx, cy), distortion, sigma)| {
        let mut device = json!({ "width": width, "height": height, "distortion": distortion,
            "K": [[fx, s, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]] });
        if let Some((focal_px, cx_px, cy_px, distortion)) = sigma {
            device["sigma"] =
                json!({ "focal_px": focal_px, "cx_px": cx_px, "cy_px": cy_px, "distortion": distortion });
        }
        device
    })
}

fn placed() -> impl Strategy<Value = Value> {
    (pose(), of([sigma(), sigma(), sigma()]), of([sigma(), sigma(), sigma()])).prop_map(|(pose, t, r)| {
        let translation: [f64; 3] = pose.translation.into();
        json!({ "R": rows(pose.rotation.matrix()), "t": translation, "sigma_t_mm": t, "sigma_r_rad": r })
    })
}

fn quality() -> impl Strategy<Value = Value> {
    let warning = ("[a-z-]{1,20}", ".{0,40}", ".{0,40}")
        .prop_map(|(code, message, advice)| json!({ "code": code, "message": message, "advice": advice }));
    let verdict = select(&["good", "fair", "weak", "degenerate"][..]);
    (verdict, sigma(), of(sigma()), of(sigma()), prop::collection::vec(warning, 0..3)).prop_map(
        |(verdict, camera, projector, point, warnings)| {
            json!({ "verdict": verdict, "focal_sigma_percent": { "camera": camera, "projector": projector },
                "expected_point_sigma_mm": point, "warnings": warnings })
        },
    )
}

fn covariance() -> impl Strategy<Value = Value> {
    (1_usize..5).prop_flat_map(|n| prop::collection::vec(number(), n * n)).prop_map(|values| {
        let n = values.len().isqrt();
        let names = [
            "camera.focal_px",
            "projector.k1",
            "projector_from_camera.rx_rad",
            "views[0].tz_mm",
            "from.elsewhere",
        ];
        let matrix: Vec<Vec<f64>> =
            (0..n).map(|i| (0..n).map(|j| values[n * i.min(j) + i.max(j)]).collect()).collect();
        json!({ "parameters": names[..n], "matrix": matrix })
    })
}

fn rig() -> impl Strategy<Value = Value> {
    let projector = of((device(), placed()));
    (device(), projector, of(quality()), of(covariance()), "[a-z]{1,9}").prop_map(
        |(camera, projector, quality, covariance, method)| {
            let (projector, place) = projector.unzip();
            json!({ "schema": "slcal-rig/1", "units": "mm", "pixel_centre": "integer", "camera": camera, "projector": projector,
                "projector_from_camera": place, "views": [], "method": method, "quality": quality, "covariance": covariance })
        },
    )
}

/// Whether everything of one file that is not null stands in another one, numbers bit for bit but for a tolerance.
fn holds(all: &Value, some: &Value, tolerance: f64) -> bool {
    match (all, some) {
        (_, Value::Null) => true,
        (Value::Object(all), Value::Object(some)) => {
            some.iter().all(|(k, v)| v.is_null() || all.get(k).is_some_and(|a| holds(a, v, tolerance)))
        }
        (Value::Array(all), Value::Array(some)) => {
            all.len() == some.len() && all.iter().zip(some).all(|(a, s)| holds(a, s, tolerance))
        }
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            a == b || (a - b).abs() <= tolerance
        }
        (all, some) => all == some,
    }
}

fn read(value: &Value) -> Rig {
    read_rig(value.to_string().as_bytes()).unwrap()
}

fn cloud() -> impl Strategy<Value = PointCloud> {
    let float = || prop_oneof![-1e5_f32..1e5, proptest::num::f32::NORMAL].prop_map(f64::from);
    let share = || (0.0_f32..=1.0).prop_map(f64::from);
    let point = ([float(), float(), float()], any::<[u8; 3]>(), share(), share(), 1_u16.., share());
    let point = point.prop_map(|(position, color, sigma_mm, noise_mm, slit, confidence)| CloudPoint {
        position: Point3::from(position),
        pixel: Point2::new(f64::NAN, f64::NAN),
        color,
        sigma_mm,
        noise_mm,
        slit: Some(slit),
        confidence,
    });
    let parts = (
        prop::collection::vec(point, 3..20),
        prop::collection::vec(any::<[prop::sample::Index; 3]>(), 0..10),
    );
    (parts, of([number(), number(), number()])).prop_map(|((points, triangles), plane)| PointCloud {
        triangles: triangles.iter().map(|t| t.map(|i| i.index(points.len()) as u32)).collect(),
        points,
        frame: if plane.is_some() { Frame::Plane } else { Frame::Camera },
        camera_centre: plane.map_or_else(Point3::origin, Point3::from),
        ..PointCloud::default()
    })
}

/// A view with a sheet by corners or by sides, σ stated for the view, for each point, or not at all.
fn view() -> impl Strategy<Value = Value> {
    any::<bool>().prop_flat_map(|stated| {
        let points = move |n: usize| {
            let point = (prop::collection::vec(-3000.0..3000.0, n), sigma());
            let point = point.prop_map(move |(coordinates, s)| [coordinates, vec![s; usize::from(stated)]].concat());
            prop::collection::vec(point, 4)
        };
        let edges = [points(2), points(2), points(2), points(2)].prop_map(|[top, right, bottom, left]| {
            json!({ "sheet_edges_px": { "top": top, "right": right, "bottom": bottom, "left": left } })
        });
        let corners = prop::collection::vec([-3000.0..3000.0, -3000.0..3000.0], 4)
            .prop_map(|corners| json!({ "sheet_corners_px": corners }));
        let more = ([1.0..5000.0, 1.0..5000.0], points(4), of(sigma()), of(sigma()), of("[a-z]{1,9}")).prop_map(
            |(size, pairs, sheet, pair, photo)| {
                json!({ "size_mm": size, "pairs": pairs, "sheet_sigma_px": sheet, "pair_sigma_px": pair, "photo": photo })
            },
        );
        (prop_oneof![corners, edges], more).prop_map(|(mut view, more)| {
            let given = more.as_object().unwrap().iter().filter(|(_, v)| !v.is_null());
            view.as_object_mut().unwrap().extend(given.map(|(k, v)| (k.clone(), v.clone())));
            view
        })
    })
}

proptest! {
    #[test]
    fn a_rig_survives_its_file(file in rig()) {
        let read = read(&file);
        let mut written = Vec::new();
        write_rig(&read, &mut written).unwrap();
        prop_assert_eq!(&read_rig(written.as_slice()).unwrap(), &read);
        // Rotations are made orthogonal when that is needed.
        let written: Value = serde_json::from_slice(&written).unwrap();
        prop_assert!(holds(&written, &file, 1e-12), "{file}\n{written}");
    }

    #[test]
    fn a_rig_survives_npz_and_opencv(file in rig()) {
        let rig = read(&file);
        for format in [ExchangeFormat::Npz, ExchangeFormat::OpenCv] {
            let exported = export_rig(&rig, format, &ExportConfig::default()).unwrap();
            let files: Vec<NamedBytes<'_>> =
                exported.files.iter().map(|f| NamedBytes { name: f.name, bytes: &f.bytes }).collect();
            let back = import_rig(None, &files, &ImportConfig::default()).unwrap();
            prop_assert_eq!(back.format, format);
            prop_assert_eq!(back.rig.camera.model, rig.camera.model);
            prop_assert_eq!(back.rig.camera.sigma, rig.camera.sigma);
            prop_assert_eq!(&back.rig.projector, &rig.projector);
            prop_assert_eq!(&back.rig.covariance, &rig.covariance);
        }
    }

    #[test]
    fn observations_survive_their_file(views in prop::collection::vec(view(), 1..4), camera in [1_u32..5000, 1_u32..5000]) {
        let file = json!({ "schema": "slcal-observations/1", "camera": { "width": camera[0], "height": camera[1] },
            "projector": { "width": 1024, "height": 768 }, "views": views });
        let read = read_observations(file.to_string().as_bytes()).unwrap();
        let mut written = Vec::new();
        write_observations(&read, &mut written).unwrap();
        prop_assert_eq!(&read_observations(written.as_slice()).unwrap(), &read);
    }

    #[test]
    fn a_cloud_survives_ply(cloud in cloud()) {
        let mut bytes = Vec::new();
        write_ply(&cloud, &mut bytes).unwrap();
        let back = read_ply(bytes.as_slice()).unwrap();
        prop_assert_eq!(back.points.len(), cloud.points.len());
        for (a, b) in back.points.iter().zip(&cloud.points) {
            // A cloud's pixels are not in the file.
            prop_assert_eq!(CloudPoint { pixel: Point2::origin(), ..*a }, CloudPoint { pixel: Point2::origin(), ..*b });
        }
        prop_assert_eq!((back.triangles, back.frame, back.camera_centre), (cloud.triangles, cloud.frame, cloud.camera_centre));
    }
}
