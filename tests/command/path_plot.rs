//! Plots of camera paths, as `flythrough path plot` draws them.

use crate::support::{flythrough, root, scene, stderr};
use base64::Engine;
use flythrough::camera::{
    CameraPath, CameraPathTiming, Interpolation, Keyframe, Orientation, Segment,
};
use flythrough::drawing::path_plot::plot;
use flythrough::scene::Scene;
use glam::{DQuat, DVec2, DVec3};
use resvg::usvg;

const BLUE: &str = "#0072B2";
const WIDE: f64 = 16.0 / 9.0;

/// Units of the sheet per pixel of the embedded pictures.
const UNITS: f64 = 4.0;

fn empty() -> Scene {
    scene("Scene(objects: [])")
}

fn path(keys: &[(f64, DVec3, f64)]) -> CameraPath {
    let key = |&(time, position, degrees): &(f64, DVec3, f64)| Keyframe {
        time,
        position,
        orientation: Orientation::Rotation(DQuat::from_rotation_y(degrees.to_radians())),
        field_of_view: 1.0,
        segment: Segment::of(Interpolation::Linear),
    };
    let keys: Vec<Keyframe> = keys.iter().map(key).collect();
    CameraPath::new(10.0, &keys, &CameraPathTiming::BY_KEYS).unwrap()
}

fn drawn(scene: &Scene, path: &CameraPath) -> String {
    let svg = plot(scene, path, WIDE, "a & b").unwrap();
    let tree = usvg::Tree::from_str(&svg, &usvg::Options::default()).unwrap();
    assert_eq!(
        (tree.size().width(), tree.size().height()),
        (1200.0, 1000.0)
    );
    // The base64 text of pictures may spell anything.
    let is_drawn = |line: &&str| !line.starts_with("<image");
    let drawn: String = svg.lines().filter(is_drawn).collect();
    assert!(!drawn.contains("NaN") && !drawn.contains("inf"));
    svg
}

fn attribute<'a>(element: &'a str, name: &str) -> &'a str {
    let (_, rest) = element.split_once(&format!(" {name}=\"")).expect(name);
    rest.split('"').next().unwrap()
}

fn number(element: &str, name: &str) -> f64 {
    attribute(element, name).parse().unwrap()
}

/// The vertices of the camera's path in the plan and in the elevation: the first blue lines after that of the legend.
fn path_lines(svg: &str) -> [Vec<DVec2>; 2] {
    let lines = svg
        .lines()
        .filter(|line| line.starts_with("<polyline") && attribute(line, "stroke") == BLUE);
    let vertices = |line: &str| {
        let points = attribute(line, "points").split_whitespace();
        points
            .map(|point| {
                let (x, y) = point.split_once(',').unwrap();
                DVec2::new(x.parse().unwrap(), y.parse().unwrap())
            })
            .collect()
    };
    let mut lines = lines.skip(1).map(vertices);
    [lines.next().unwrap(), lines.next().unwrap()]
}

/// An embedded picture by its index: its left, top, width and height on the sheet, and its pixels.
fn picture(svg: &str, index: usize) -> ([f64; 4], image::GrayImage) {
    let element = svg
        .lines()
        .filter(|line| line.starts_with("<image"))
        .nth(index)
        .unwrap();
    let rectangle = ["x", "y", "width", "height"].map(|name| number(element, name));
    let data = attribute(element, "href")
        .strip_prefix("data:image/png;base64,")
        .unwrap();
    let png = base64::engine::general_purpose::STANDARD
        .decode(data)
        .unwrap();
    (
        rectangle,
        image::load_from_memory(&png).unwrap().into_luma8(),
    )
}

/// The middle of all of a picture that is not white, on the sheet.
fn middle_of_content(svg: &str, index: usize) -> DVec2 {
    let (rectangle, picture) = picture(svg, index);
    let content = picture
        .enumerate_pixels()
        .filter(|(_, _, grey)| grey.0[0] < 255);
    let (mut from, mut to) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for (x, y, _) in content {
        let pixel = DVec2::new(f64::from(x), f64::from(y));
        from = from.min(pixel);
        to = to.max(pixel + 1.0);
    }
    let size = DVec2::new(picture.width().into(), picture.height().into());
    DVec2::new(rectangle[0], rectangle[1])
        + DVec2::new(rectangle[2], rectangle[3]) * (0.5 * (from + to) / size)
}

/// The labels of the lower and the left axis of the panel with a title: numbers, and their positions along the axis.
fn labels(svg: &str, title: &str) -> [Vec<(f64, f64)>; 2] {
    let (_, rest) = svg.split_once(title).unwrap();
    let (axes, _) = rest.split_once("<polygon").unwrap();
    let lines: Vec<&str> = axes.lines().collect();
    let of = |anchor: &str, along: &str| {
        let texts = lines.windows(2).filter(|pair| {
            pair[0].starts_with("<text") && attribute(pair[0], "text-anchor") == anchor
        });
        let labels = texts.filter_map(|pair| {
            let value: f64 = pair[1].parse().ok()?;
            Some((value, number(pair[0], along)))
        });
        labels.collect()
    };
    [of("middle", "x"), of("end", "y")]
}

/// The value at a position along an axis, interpolated between its labels.
fn value_at(labels: &[(f64, f64)], position: f64) -> f64 {
    let ((a, from), (b, to)) = (labels[0], labels[labels.len() - 1]);
    assert!(labels.len() > 1 && from != to);
    a + (b - a) * (position - from) / (to - from)
}

#[test]
fn every_frame_is_drawn_at_its_coordinates() {
    let keys = [
        (0.0, DVec3::new(1.0, 2.0, -1.0), 0.0),
        (1.0, DVec3::new(2.0, 3.0, -9.0), 0.0),
    ];
    let path = path(&keys);
    let svg = drawn(&empty(), &path);
    assert!(svg.contains("a &amp; b: 11 frames at 10 per second, 1 s, 8.12 m"));
    let panels = [("Plan: ", [0, 2]), ("Elevation: towards +x", [2, 1])];
    for (line, (title, axes)) in path_lines(&svg).iter().zip(panels) {
        assert_eq!(line.len(), 11);
        let [lower, left] = labels(&svg, title);
        for (frame, vertex) in (0..).zip(line) {
            let position = path.camera(frame).position;
            let values = [value_at(&lower, vertex.x), value_at(&left, vertex.y)];
            for (value, axis) in values.iter().zip(axes) {
                assert!((value - position[axis]).abs() < 0.03, "{frame}: {value}");
            }
        }
    }
}

#[test]
fn scene_and_path_are_drawn_at_the_same_coordinates() {
    // A ball below and beside the middle of the path.
    let ball = scene(
        "Scene(materials: {\"m\": (diffuse: (1, 1, 1))}, objects: [
            sphere(center: (1000003, -2, 7), radius: 0.5, material: \"m\"),
        ])",
    );
    let at = |x: f64, z: f64| DVec3::new(1e6 + x, -1.0, z);
    for [from, to] in [[at(1.0, 7.0), at(5.0, 7.0)], [at(3.0, 4.0), at(3.0, 10.0)]] {
        let svg = drawn(&ball, &path(&[(0.0, from, 0.0), (1.0, to, 0.0)]));
        let [plan, elevation] = path_lines(&svg);
        let difference = middle_of_content(&svg, 0) - plan[5];
        assert!(difference.abs().max_element() <= UNITS, "{difference}");
        // A metre below the path.
        let difference = middle_of_content(&svg, 1) - elevation[5];
        assert!(
            difference.x.abs() <= UNITS && difference.y > 0.0,
            "{difference}"
        );
        let metre = if from.x == to.x {
            (elevation[10].x - elevation[0].x) / 6.0
        } else {
            (elevation[10].x - elevation[0].x) / 4.0
        };
        assert!((difference.y - metre).abs() <= 2.0 * UNITS, "{difference}");
    }
}

#[test]
fn all_paths_can_be_drawn() {
    let point = DVec3::new(1.0, 2.0, 3.0);
    let far = DVec3::splat(1e6);
    let room = scene(
        "Scene(materials: {\"m\": (diffuse: (1, 1, 1))}, objects: [
            sphere(radius: 2, material: \"m\"),
        ])",
    );
    let paths = [
        ("still", path(&[(0.0, point, 0.0)])),
        ("turning", path(&[(0.0, point, 0.0), (3.0, point, 170.0)])),
        ("standing", path(&[(0.0, point, 0.0), (3.0, point, 0.0)])),
        (
            "vertical",
            path(&[(0.0, point, 0.0), (3.0, point + DVec3::Y, 0.0)]),
        ),
        (
            "level",
            path(&[(0.0, point, 0.0), (3.0, point + DVec3::X, 0.0)]),
        ),
        ("far", path(&[(0.0, far, 0.0), (3.0, far + DVec3::Z, 0.0)])),
        ("far still", path(&[(0.0, far, 0.0)])),
        ("long", path(&[(0.0, -far, 0.0), (3.0, far, 0.0)])),
        (
            "short",
            path(&[(0.0, point, 0.0), (3.0, point + 1e-9, 0.0)]),
        ),
        (
            "inside",
            path(&[(0.0, DVec3::ZERO, 0.0), (3.0, DVec3::X, 0.0)]),
        ),
    ];
    for (name, path) in &paths {
        for scene in [&room, &empty()] {
            let svg = drawn(scene, path);
            let says = |what: &str| svg.lines().any(|line| line.trim() == what);
            assert!(says("start") && says("end") || says("start, end"), "{name}");
        }
    }
}

#[test]
fn drawings_of_many_frames_and_keys_stay_small() {
    let key = |number: u32| {
        let angle = f64::from(number) * 0.01;
        let position = DVec3::new(angle.cos(), 0.1 * angle, angle.sin()) * 10.0;
        (f64::from(number), position, 0.0)
    };
    let keys: Vec<(f64, DVec3, f64)> = (0..1001).map(key).collect();
    let path = path(&keys);
    assert_eq!(path.timeline().frame_count(), 10_001);
    let svg = drawn(&empty(), &path);
    let count = |start: &str| svg.lines().filter(|line| line.starts_with(start)).count();
    assert!(count("<circle") <= 2 * 120 + 10, "{}", count("<circle"));
    assert!(count("<text") < 300, "{}", count("<text"));
    assert!(svg.len() < 1_000_000, "{}", svg.len());
}

#[test]
fn the_command_writes_a_file_or_names_the_fault() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("path.svg");
    let [scene, path] = ["scenes/test3.ron", "paths/test3.ron"].map(|file| root().join(file));
    let [scene, path] = [&scene, &path].map(|file| file.to_str().unwrap());
    let plot = |path: &str, out: &std::path::Path| {
        flythrough(&["path", "plot", scene, path, "--out", out.to_str().unwrap()])
    };
    let output = plot(path, &out);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let svg = std::fs::read_to_string(&out).unwrap();
    usvg::Tree::from_str(&svg, &usvg::Options::default()).unwrap();
    assert!(svg.contains("test3: 49 frames"));
    let nowhere = folder.path().join("no/path.svg");
    let output = plot(path, &nowhere);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("path.svg"));
    assert_eq!(plot(scene, &out).status.code(), Some(2));
}
