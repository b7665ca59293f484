use nalgebra::Point2;
use serde_json::{Value, json};

use super::*;
use crate::error::ErrorClass;
use crate::observations::SheetObservation;

fn sample() -> Value {
    json!({
        "schema": "slcal-observations/1",
        "camera": {"width": 1280, "height": 960},
        "projector": {"width": 1024, "height": 768},
        "views": [{
            "size_mm": [594, 420.0],
            "sheet_corners_px": [[100.25, 90], [1100, 110], [1050, 800], [-20, 780]],
            "pairs": [[400, 300, 271.5, 233.5], [600, 310, 511.5, 233.5], [590, 500, 511.5, 473.5], [390, 510, 271.5, 473.5]],
        }],
    })
}

fn with(change: impl FnOnce(&mut Value)) -> Value {
    let mut value = sample();
    change(&mut value);
    value
}

fn read(value: &Value) -> Result<Observations> {
    read_observations(value.to_string().as_bytes())
}

/// Asserts that reading fails as malformed, with all of `words` in the message.
fn refused(value: &Value, words: &[&str]) {
    let error = read(value).unwrap_err();
    assert_eq!(error.class(), ErrorClass::Input, "{error}");
    for word in words {
        assert!(error.to_string().contains(word), "no {word:?} in: {error}");
    }
}

#[test]
fn what_the_schema_says_is_read() {
    let o = read(&sample()).unwrap();
    assert_eq!((o.camera, o.projector), ([1280, 960], Some([1024, 768])));
    let view = &o.views[0];
    assert_eq!((view.size.width_mm, view.size.height_mm), (594.0, 420.0));
    assert_eq!(view.sheet.corners().unwrap()[0], Point2::new(100.25, 90.0));
    assert_eq!(view.pairs[1].projector, Point2::new(511.5, 233.5));
    assert_eq!(view.pairs[1].camera, Point2::new(600.0, 310.0));
    assert!(!view.states_sheet_sigma() && !view.states_pair_sigma());
}

#[test]
fn the_camera_alone_needs_no_pairs() {
    let alone = with(|v| {
        v["projector"] = Value::Null;
        v["views"][0].as_object_mut().unwrap().remove("pairs");
    });
    let o = read(&alone).unwrap();
    assert_eq!(o.projector, None);
    assert!(!o.views[0].states_sheet_sigma() && o.views[0].pairs.is_empty());
}

#[test]
fn noise_is_stated_by_view_or_by_point() {
    let o = read(&with(|v| {
        v["views"][0]["sheet_sigma_px"] = json!(0.2);
        for p in v["views"][0]["pairs"].as_array_mut().unwrap() {
            p.as_array_mut().unwrap().push(json!(0.1));
        }
    }))
    .unwrap();
    assert!(o.views[0].states_sheet_sigma() && o.views[0].states_pair_sigma());
    assert_eq!(o.views[0].pairs[3].sigma_px, Some(0.1));
    let SheetObservation::Corners { sigma_px, .. } = o.views[0].sheet else { panic!() };
    assert_eq!(sigma_px, Some(0.2));
    refused(
        &with(|v| v["views"][0]["pairs"][2] = json!([1, 2, 3, 4, 0.1])),
        &["views[0].pairs", "[2]", "[0]"],
    );
    refused(&with(|v| v["views"][0]["pairs"][0] = json!([1, 2, 3, 4, 0])), &["pairs[0]", "positive σ"]);
    refused(&with(|v| v["views"][0]["sheet_sigma_px"] = json!(-1)), &["sheet_sigma_px", "-1"]);
    refused(&with(|v| v["views"][0]["pair_sigma_px"] = json!("0.1")), &["pair_sigma_px", "\"0.1\""]);
}

#[test]
fn edges_are_read_in_the_order_of_the_sides() {
    let edges = |third: Value| {
        with(|v| {
            let view = v["views"][0].as_object_mut().unwrap();
            view.remove("sheet_corners_px");
            let side = |y: f64| json!([[0.0, y], [10.0, y]]);
            view.insert(
                "sheet_edges_px".into(),
                json!({"left": side(4.0), "bottom": side(3.0), "right": third, "top": side(1.0)}),
            );
        })
    };
    let o = read(&edges(json!([[0, 2], [10, 2]]))).unwrap();
    let SheetObservation::Edges(sides) = &o.views[0].sheet else { panic!() };
    assert_eq!(sides.each_ref().map(|s| s[1].position.y), [1.0, 2.0, 3.0, 4.0]);
    refused(&edges(json!([[0, 2, 0.1], [10, 2, 0.1]])), &["sheet_edges_px", "some sides"]);
    refused(&edges(json!([[0, 2], [10, null]])), &["views[0].sheet_edges_px.right[1][1]", "null"]);
}

#[test]
fn what_is_wrong_is_named() {
    refused(&json!([]), &["an object", "slcal-observations/1"]);
    refused(
        &with(|v| v["schema"] = json!("slcal-observations/2")),
        &["slcal-observations/1", "slcal-observations/2"],
    );
    refused(&with(|v| v["camera"]["width"] = json!(0)), &["camera.width", "0"]);
    refused(&with(|v| v["camera"]["width"] = json!(-5)), &["camera.width", "-5"]);
    refused(&with(|v| v["camera"] = Value::Null), &["camera", "null"]);
    refused(&with(|v| v["views"] = json!({})), &["views", "list"]);
    refused(&with(|v| v["views"][0] = json!(3)), &["views[0]", "3"]);
    refused(
        &with(|v| v["views"][0]["size_mm"] = json!([0.594, 0.42])),
        &["views[0].size_mm", "millimetres", "0.594"],
    );
    refused(&with(|v| v["views"][0]["size_mm"] = json!([594])), &["views[0].size_mm"]);
    refused(
        &with(|v| v["views"][0]["sheet_corners_px"][2][0] = Value::Null),
        &["views[0].sheet_corners_px[2][0]", "null"],
    );
    refused(
        &with(|v| v["views"][0]["sheet_corners_px"] = json!([[1, 2], [3, 4], [5, 6]])),
        &["four corners", "found 3"],
    );
    refused(&with(|v| v["views"][0]["sheet_corners_px"][0] = json!([1])), &["sheet_corners_px[0]", "[x, y]"]);
    refused(&with(|v| v["views"][0]["pairs"][3] = json!([1, 2, 3])), &["views[0].pairs[3]", "projector_y"]);
    refused(&with(|v| v["views"][0]["pairs"][3][2] = json!(1e300)), &["pairs[3][2]", "1e+300"]);
    refused(&with(|v| v["views"][0]["sheet_edges_px"] = json!({})), &["either", "both"]);
    for field in ["schema", "camera", "projector", "views"] {
        refused(&with(|v| drop(v.as_object_mut().unwrap().remove(field))), &["missing field", field]);
    }
    for field in ["size_mm", "pairs"] {
        let drop_field = |v: &mut Value| drop(v["views"][0].as_object_mut().unwrap().remove(field));
        refused(&with(drop_field), &["views[0]", "missing field", field]);
    }
    let neither = |v: &mut Value| drop(v["views"][0].as_object_mut().unwrap().remove("sheet_corners_px"));
    refused(&with(neither), &["either", "neither"]);
}

#[test]
fn what_is_no_json_is_told_where() {
    for text in ["", "nonsense", "{\"schema\": NaN}", "{\"views\": [1e999]}", &"[".repeat(100_000), "\0\u{1}"]
    {
        let error = read_observations(text.as_bytes()).unwrap_err();
        assert!(error.to_string().contains("line"), "{error}");
    }
    assert!(read_observations(&[0xFF, 0xFE, 0x00][..]).is_err());
}

#[test]
fn writing_and_reading_give_the_same_bits() {
    let mut value = with(|v| {
        v["views"][0]["photo"] = json!("a \"b\".jpg");
        v["views"][0]["sheet_sigma_px"] = json!(0.1 + 0.2);
        v["views"][0]["pair_sigma_px"] = json!(1.0 / 3.0);
        v["views"][0]["pairs"][0][0] = json!(std::f64::consts::PI * 1e-7);
    });
    let second = json!({"size_mm": [297, 210], "pairs": [], "sheet_edges_px": {
        "top": [[0, 1, 0.5]], "right": [[1, 2, 0.25]], "bottom": [], "left": [[0.1, 0.7, 1e-3]]}});
    value["views"].as_array_mut().unwrap().push(second);
    let o = read(&value).unwrap();
    let mut text = Vec::new();
    write_observations(&o, &mut text).unwrap();
    assert_eq!(read_observations(text.as_slice()).unwrap(), o);
    let unstated = read(&sample()).unwrap();
    text.clear();
    write_observations(&unstated, &mut text).unwrap();
    assert_eq!(read_observations(text.as_slice()).unwrap(), unstated);
    let mut nan = unstated;
    nan.views[0].pairs[0].camera.x = f64::NAN;
    assert!(write_observations(&nan, Vec::new()).is_err());
}

#[test]
fn panel_points_are_read_and_written_to_the_same_bits() {
    let with_points = |points: Value| with(|v| v["views"][0]["panel_points"] = points);
    let read_points =
        read(&with_points(json!([[30.5, 400.1, -0.5, null, 0.3], [700, 900, null, 767.5], [9, 8, 24, 25]])));
    let o = read_points.unwrap();
    let points = &o.views[0].panel_points;
    assert_eq!(points[0].expected, [Some(-0.5), None]);
    assert_eq!((points[0].camera, points[0].sigma_px), (Point2::new(30.5, 400.1), Some(0.3)));
    assert_eq!((points[1].expected, points[1].sigma_px), ([None, Some(767.5)], None));
    assert_eq!(points[2].expected, [Some(24.0), Some(25.0)]);
    let mut text = Vec::new();
    write_observations(&o, &mut text).unwrap();
    assert_eq!(read_observations(text.as_slice()).unwrap(), o);
    refused(&with_points(json!(7)), &["views[0].panel_points", "list"]);
    refused(
        &with_points(json!([[1, 2, null, null]])),
        &["views[0].panel_points[0]", "coordinate of the panel"],
    );
    refused(&with_points(json!([[1, 2, 3, 4, 0.0]])), &["views[0].panel_points[0]", "positive σ"]);
    refused(&with_points(json!([[1, "a", 3, 4]])), &["views[0].panel_points[0][1]", "finite number"]);
    refused(&with_points(json!([[1, 2, 3]])), &["views[0].panel_points[0]", "panel_x or null"]);
}

#[test]
fn channel_offsets_are_read_and_written_to_the_same_bits() {
    let with_offsets = |rows: Value| with(|v| v["views"][0]["channel_offsets"] = rows);
    let row = json!([400.1, 300.2, 271.5, 233.5, 0.25, -0.125, -0.3, 0.4, 0.05, 0.06]);
    let o = read(&with_offsets(json!([row]))).unwrap();
    let offset = &o.views[0].channel_offsets[0];
    assert_eq!((offset.offset_px.red.x, offset.offset_px.blue.y, offset.sigma_px.blue), (0.25, 0.4, 0.06));
    let mut text = Vec::new();
    write_observations(&o, &mut text).unwrap();
    assert_eq!(read_observations(text.as_slice()).unwrap(), o);
    refused(&with_offsets(json!([[1, 2, 3]])), &["views[0].channel_offsets[0]", "σ_blue"]);
    refused(
        &with_offsets(json!([[1, 2, 3, 4, 0, 0, 0, 0, 0.05, 0]])),
        &["views[0].channel_offsets[0]", "positive σ", "found 0.05 and 0"],
    );
}
