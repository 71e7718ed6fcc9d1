//! What the program says of where light comes from, and the headlight.

use crate::support::*;
use std::path::Path;

const PATH: &str =
    "CameraPath(fps: 24, keyframes: [(time: 0, position: (0, 1, 3), look_at: (0, 0, 0), fov: 50)])";

fn write(folder: &Path, scene: &str) -> [String; 2] {
    [("s.ron", scene), ("p.ron", PATH)].map(|(name, text)| {
        let file = folder.join(name);
        std::fs::write(&file, text).unwrap();
        file.to_str().unwrap().to_owned()
    })
}

/// Powers by hand: 4 pi I of a point, pi L A of each side that emits.
#[test]
fn check_and_render_say_where_light_comes_from() {
    let folder = tempfile::tempdir().unwrap();
    let lamp = plate(2.0, 0.5, "lamp") + &plate(1.0, 0.5, "panel");
    let [scene, path] = write(
        folder.path(),
        &format!(
            "Scene(
                background: (0, 0, 2),
                materials: {{
                    \"grey\": (diffuse: (0.5, 0.5, 0.5)),
                    \"lamp\": (emission: (1, 2, 4)),
                    \"panel\": (emission: (10, 10, 10), two_sided: true),
                }},
                lights: [
                    (position: (0, 3, 0), intensity: (1, 1, 1)),
                    sun(direction: (0, -1, 0), irradiance: (5, 5, 5)),
                    (position: (1, 3, 0), intensity: (2, 2, 2), radius: 0.1),
                ],
                objects: [{}{lamp}],
            )",
            plate(0.0, 2.0, "grey")
        ),
    );
    let groups = [
        "point lights, 2 of them: 37.7 W",
        "suns: 5 W/m²",
        "surfaces of \"lamp\", 2 of them: (3.14, 6.28, 12.6) W",
        "surfaces of \"panel\", 2 of them: 62.8 W",
        "background: (0, 0, 2) W/(sr m²)",
    ];
    let checked = flythrough(&["check", &scene, &path]);
    let printed = String::from_utf8(checked.stdout).unwrap();
    for group in groups {
        assert!(
            printed.contains(&format!("           {group}\n")),
            "{printed}"
        );
    }
    let out = folder.path().join("out");
    let out = out.to_str().unwrap();
    let rendered = flythrough(&["render", &scene, &path, "--out", out, "--size", "16x9"]);
    let printed = String::from_utf8(rendered.stdout).unwrap();
    let line = format!("light: {}\n", groups.join("; "));
    assert!(printed.contains(&line), "{printed}");
}

/// Without any light the warning offers the headlight, which shows a white floor at 45 degrees in every mode.
#[test]
fn a_headlight_shows_a_scene_without_light() {
    let folder = tempfile::tempdir().unwrap();
    let floor = plate(0.0, 9.0, "white");
    let [scene, path] = write(
        folder.path(),
        &format!("Scene(materials: {{\"white\": (diffuse: (1, 1, 1))}}, objects: [{floor}])"),
    );
    let checked = flythrough(&["check", &scene, &path]);
    assert!(stderr(&checked).contains("or look at the scene with `--light camera`"));
    assert!(stderr(&flythrough(&["check", &scene, &path, "--light", "camera"])).is_empty());
    // Of what nothing lit the error is not 0.
    let dark = folder.path().join("dark");
    let dark = dark.to_str().unwrap();
    let rendered = flythrough(&["render", &scene, &path, "--out", dark, "--size", "16x9"]);
    let printed = String::from_utf8(rendered.stdout).unwrap();
    let unknown = "error unknown: nothing lights the surfaces";
    assert!(
        printed.contains(unknown) && !printed.contains("relMSE"),
        "{printed}"
    );
    let table = std::fs::read_to_string(format!("{dark}/errors.csv")).unwrap();
    let errors = table.lines().nth(1).unwrap();
    assert_eq!(errors, "0,inf,0e0,inf,inf,inf");
    let again = flythrough(&["render", &scene, &path, "--out", dark, "--size", "16x9"]);
    let printed = String::from_utf8(again.stdout).unwrap();
    assert!(printed.starts_with("0 frames rendered"), "{printed}");
    for mode in ["raytracing", "supersampling", "montecarlo"] {
        let out = folder.path().join(mode);
        let out = out.to_str().unwrap();
        let all = [
            "render", &scene, &path, "--out", out, "--size", "16x9", "--light", "camera", "--mode",
            mode,
        ];
        let rendered = flythrough(&all);
        assert_eq!(rendered.status.code(), Some(0), "{}", stderr(&rendered));
        let printed = String::from_utf8_lossy(&rendered.stdout);
        assert!(printed.contains("error (relMSE)"), "{printed}");
        let picture = image::open(format!("{out}/frame_00000.png"))
            .unwrap()
            .into_rgb8();
        // The cosine, 1 / sqrt(10), times 0.9.
        let code = picture.get_pixel(8, 4).0[0];
        let expected = flythrough::math::color::linear_to_srgb(0.9 / 10_f32.sqrt()) * 255.0;
        assert!(
            (f32::from(code) - expected).abs() < 3.0,
            "{mode}: {code} {expected}"
        );
    }
    assert_eq!(
        flythrough(&["check", &scene, &path, "--light", "moon"])
            .status
            .code(),
        Some(2)
    );
}
