//! Jumps and spikes of the camera's velocity and angular velocity.

use super::steps::measure_steps;
use super::warning::Measured;
use super::{PathWarning, WarningKind};
use crate::camera::FrameCameras;
use glam::DVec3;

/// The ratio of a step to the median step above which it is a spike: twice the ratio that easing and corners cause.
const FAST: f64 = 4.0;

/// The least change that is a jump, relative to the median speed: that of a corner of 11 degrees. A quarter of it is
/// the least difference of speeds that is visible (McKee 1981, "A local mechanism for differential velocity
/// detection").
const MIN_JUMP: f64 = 0.2;

/// The least ratio of a jump, over two frames, to the changes from frame to frame around it: twice that of a constant
/// acceleration.
const ABRUPT: f64 = 4.0;

/// The least size of each of the two changes of a stutter, relative to the least jump: half the median speed.
const STUTTER: f64 = 2.5;

/// The least fraction of each change of a stutter that the other one cancels.
const CANCELLED: f64 = 0.5;

/// Steps below this fraction of the coordinates are rounding by programs that store single precision.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// Longer steps, in metres, are no rounding, however large the coordinates.
const MAX_ROUNDING: f64 = 5e-4;

/// The least turn in radians; smaller ones are rounding.
const MIN_TURN: f64 = 1e-6;

/// Jumps of the angular velocity below this many pixels per second are invisible.
const UNSEEN_PIXELS: f64 = 24.0;

pub(super) fn find(frames: &FrameCameras, height: u32) -> Vec<PathWarning> {
    let cameras = frames.cameras.iter();
    let size = cameras.fold(0.0_f64, |size, camera| {
        size.max(camera.position.abs().max_element())
    });
    let fps = frames.fps;
    let steps = measure_steps(frames, |from, to| to.position - from.position);
    let turns = measure_steps(frames, |from, to| from.rotation * from.turn_to(to));
    let mut warnings = Vec::new();
    if let Some(median) = median_length(&steps, (ROUNDING * size).min(MAX_ROUNDING)) {
        let length = |(frame, step): (usize, &Option<DVec3>)| Some((frame, (*step)?.length()));
        let fast: Vec<Measured> = (steps.iter().enumerate())
            .filter_map(length)
            .filter(|(_, length)| *length > FAST * median)
            .collect();
        let median_speed = median * fps;
        warnings.extend(PathWarning::of(&fast, |frame, length| {
            WarningKind::SpeedSpike {
                frame,
                speed: length * fps,
                median: median_speed,
            }
        }));
        let jumps = jumps(&steps, |_| MIN_JUMP * median);
        let (at_seam, jumps) = split_seam(frames, jumps);
        warnings.extend(PathWarning::of(&jumps, |frame, jump| {
            WarningKind::VelocityJump {
                frame,
                jump: jump * fps,
                median: median_speed,
            }
        }));
        warnings.extend(PathWarning::of(&at_seam, |_, jump| {
            WarningKind::VelocityJumpAtSeam {
                jump: jump * fps,
                median: median_speed,
            }
        }));
    }
    if let Some(median) = median_length(&turns, MIN_TURN) {
        let pixel = |frame: usize| 2.0 * frames.cameras[frame].half_height / f64::from(height);
        let unseen = |frame| UNSEEN_PIXELS / fps * pixel(frame);
        let jumps = jumps(&turns, |frame| unseen(frame).max(MIN_JUMP * median));
        let (at_seam, jumps) = split_seam(frames, jumps);
        warnings.extend(PathWarning::of(&jumps, |frame, jump| {
            WarningKind::AngularVelocityJump {
                frame,
                jump: jump * fps,
            }
        }));
        warnings.extend(PathWarning::of(&at_seam, |_, jump| {
            WarningKind::AngularVelocityJumpAtSeam { jump: jump * fps }
        }));
    }
    warnings
}

/// The median length of the steps that are longer than `least`; none if there are none.
fn median_length(steps: &[Option<DVec3>], least: f64) -> Option<f64> {
    let lengths = steps.iter().flatten().map(|step| step.length());
    let mut moving: Vec<f64> = lengths.filter(|length| *length > least).collect();
    moving.sort_unstable_by(f64::total_cmp);
    moving.get(moving.len() / 2).copied()
}

/// The frames at which steps change abruptly, by more than `least` of the frame, and the change.
///
/// A corner between two frames spreads its change over both, so steps are compared with those two before. A jump stands
/// out from the changes around it, which no smooth curve does, however narrow; or it is cancelled by the next change,
/// which is a stutter. At the ends of a shot, without enough frames around, nothing is found.
fn jumps(steps: &[Option<DVec3>], least: impl Fn(usize) -> f64) -> Vec<Measured> {
    let count = steps.len() as isize;
    // Cyclic: after the last frame of an open path there is no step.
    let step = |frame: isize| steps[frame.rem_euclid(count) as usize];
    let difference = |from: isize, to: isize| -> Option<DVec3> {
        let all = (from..=to).all(|frame| step(frame).is_some());
        Some(step(to)? - step(from)?).filter(|_| all)
    };
    let length = |from, to| Some(difference(from, to)?.length());
    let jump = |frame: isize| {
        // Within one shot.
        let change = |offset: isize| {
            let (first, last) = (frame + offset.min(0) - 1, frame + offset.max(0));
            difference(first, last).and(difference(frame + offset - 1, frame + offset))
        };
        let (least, size) = (least(frame as usize), change(0)?.length());
        if is_stutter([-1, 0, 1, 2].map(change), least) {
            return Some(size);
        }
        let change = |offset: isize| change(offset).map(DVec3::length);
        let is_peak = change(-1).is_none_or(|before| before < size)
            && change(1).is_none_or(|after| after <= size);
        let pairs = [length(frame - 2, frame), length(frame - 1, frame + 1)];
        let jump = pairs.into_iter().flatten().fold(size, f64::max);
        let before = [-3, -2].into_iter().filter_map(change).reduce(f64::max)?;
        let after = [2, 3].into_iter().filter_map(change).reduce(f64::max)?;
        (is_peak && jump > least + ABRUPT * before.max(after)).then_some(jump)
    };
    let frames = (0..count).filter_map(|frame| Some((frame as usize, jump(frame)?)));
    frames.collect()
}

/// Whether the inner two of four successive changes cancel each other, as where a frame is shown twice. Around a short
/// stop, however it is eased, each outer change continues the inner one beside it.
fn is_stutter([before, first, second, after]: [Option<DVec3>; 4], least: f64) -> bool {
    let (Some(first), Some(second)) = (first, second) else {
        return false;
    };
    let fraction = |a: DVec3, of: DVec3| a.dot(of) / of.length_squared();
    let is_alone =
        |inner, outer: Option<DVec3>| outer.is_none_or(|outer| fraction(outer, inner) < CANCELLED);
    first.length().min(second.length()) > STUTTER * least
        && fraction(second, first) < -CANCELLED
        && fraction(first, second) < -CANCELLED
        && is_alone(first, before)
        && is_alone(second, after)
}

/// Splits what is found at the seam of a closed path from what is found elsewhere.
fn split_seam(frames: &FrameCameras, found: Vec<Measured>) -> (Vec<Measured>, Vec<Measured>) {
    let last = frames.cameras.len() - 1;
    let is_at_seam = |(frame, _): &Measured| frames.is_closed && (*frame == 0 || *frame == last);
    found.into_iter().partition(is_at_seam)
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{FPS, open_shot, path, still};
    use super::*;
    use crate::camera::Interpolation::{self, CatmullRom, Linear};
    use crate::camera::{CameraPath, CameraPathTiming, Keyframe, Orientation, Segment};
    use crate::preflight::FrameRuns;
    use crate::sampling::Random;
    use std::f64::consts::{PI, TAU};

    const HEIGHT: u32 = 720;

    /// Warnings of a path through keys of a time, x and z. It looks at one point far away, so that it hardly turns.
    fn of_keys(interpolation: Interpolation, keys: &[(f64, f64, f64)]) -> Vec<PathWarning> {
        let target = DVec3::new(3.0, 0.0, -1e5);
        let keys: Vec<(f64, DVec3, DVec3)> = keys
            .iter()
            .map(|&(time, x, z)| (time, DVec3::new(x, 1.7, z), target))
            .collect();
        find(&FrameCameras::of(&path(interpolation, &keys)), HEIGHT)
    }

    const CORNER: [(f64, f64, f64); 3] = [(0.0, 0.0, 0.0), (2.0, 0.0, -2.0), (4.0, 1.0, -3.7)];

    #[test]
    fn smooth_paths_have_no_warnings() {
        assert_eq!(of_keys(CatmullRom, &CORNER), []);
        assert_eq!(of_keys(Linear, &[CORNER[0], CORNER[2]]), []);
        assert_eq!(of_keys(Linear, &[CORNER[0]]), []);
        // Moves and stops, twice; at two scales, the smaller with half a second for a move.
        for scale in [1.0, 0.25] {
            let stops = [
                (0.0, 0.0, 0.0),
                (1.0, 0.0, 0.0),
                (3.0, 0.0, -2.0),
                (4.0, 0.0, -2.0),
                (6.0, 2.0, -2.0),
                (7.0, 2.0, -2.0),
            ];
            let stops = stops.map(|(time, x, z)| (scale * time, scale * x, scale * z));
            assert_eq!(of_keys(CatmullRom, &stops), [], "{scale}");
        }
        // A circle, and a look around.
        let around = |frame: u32| {
            let (sin, cos) = (TAU * f64::from(frame) / 240.0).sin_cos();
            still(
                DVec3::new(1e6 + 3.0 * cos, 1.7, 3.0 * sin),
                DVec3::new(cos, 0.2, sin),
            )
        };
        assert_eq!(find(&open_shot((0..240).map(around).collect()), HEIGHT), []);
        let mut closed = open_shot((0..240).map(around).collect());
        closed.is_closed = true;
        assert_eq!(find(&closed, HEIGHT), []);
    }

    /// Random paths of at least 15 frames to a segment, whose camera rests at some of the keys.
    #[test]
    fn random_smooth_paths_have_no_jumps() {
        let mut random = Random::new(5);
        for round in 0..400 {
            let mut time = 0.0;
            let mut key = |_| {
                time += 15.0 / FPS + 2.0 * f64::from(random.unit()).powi(2);
                let is_eased = random.unit() < 0.5;
                let angles = random.point() * DVec3::new(3.0, 0.5, 0.2);
                Keyframe {
                    time,
                    position: 3.0 * random.point(),
                    orientation: Orientation::YawPitchRoll(angles),
                    field_of_view: 1.0,
                    segment: Segment {
                        interpolation: CatmullRom,
                        ease_in: is_eased,
                        ease_out: is_eased,
                    },
                }
            };
            let keys: Vec<Keyframe> = (0..8).map(&mut key).collect();
            let path = CameraPath::new(FPS, &keys, &CameraPathTiming::BY_KEYS).expect("keys");
            let mut found = find(&FrameCameras::of(&path), HEIGHT);
            found.retain(|finding| !matches!(finding.kind, WarningKind::SpeedSpike { .. }));
            assert_eq!(found, [], "{round}");
        }
    }

    #[test]
    fn corners_of_linear_paths_are_jumps() {
        // From (0, -1) m/s to (0.5, -0.85) m/s; also where the key is between two frames.
        for late in [0.0, 0.01, 0.02] {
            let keys =
                CORNER.map(|(time, x, z)| (time + if time == 2.0 { late } else { 0.0 }, x, z));
            let found = of_keys(Linear, &keys);
            assert_eq!(found.len(), 1, "{found:?}");
            assert!(
                [[[48, 48]], [[49, 49]]]
                    .iter()
                    .any(|runs| found[0].frames.runs() == runs)
            );
            let WarningKind::VelocityJump { jump, median, .. } = found[0].kind else {
                panic!("{found:?}")
            };
            assert!((jump - 0.522).abs() < 0.02, "{jump}");
            assert!((median - 0.99).abs() < 0.02, "{median}");
        }
        // An abrupt stop is a jump; a key that changes nothing is none.
        let stop = [(0.0, 0.0, 0.0), (2.0, 0.0, -2.0), (4.0, 0.0, -2.0)];
        let found = of_keys(Linear, &stop);
        assert_eq!(found.len(), 1);
        assert!(matches!(
            found[0].kind,
            WarningKind::VelocityJump { frame: 48, .. }
        ));
        assert_eq!(of_keys(Linear, &[stop[0], (0.7, 0.0, -0.7), stop[1]]), []);
    }

    #[test]
    fn speed_spikes_and_single_displaced_frames_are_found() {
        let dash = [
            (0.0, 0.0, 0.0),
            (3.0, 0.0, -3.0),
            (4.0, 0.0, -9.0),
            (7.0, 0.0, -12.0),
        ];
        let found = of_keys(CatmullRom, &dash);
        assert_eq!(found.len(), 1, "{found:?}");
        let WarningKind::SpeedSpike { frame, speed, .. } = found[0].kind else {
            panic!("{found:?}")
        };
        assert!((72..96).contains(&frame) && speed > 5.0 && speed < 12.0);
        // One frame is beside the path.
        let camera = |i: u32| {
            let beside = if i == 30 { 0.02 } else { 0.0 };
            still(DVec3::new(beside, 0.0, -0.05 * f64::from(i)), DVec3::NEG_Z)
        };
        let found = find(&open_shot((0..60).map(camera).collect()), HEIGHT);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(matches!(
            found[0].kind,
            WarningKind::VelocityJump { frame: 30, .. }
        ));
    }

    #[test]
    fn stutters_are_found() {
        // Every second, third or fourth frame is shown twice.
        for period in 2..=4 {
            let camera = |i: u32| {
                let distance = 0.05 * f64::from(i - i / period);
                still(DVec3::NEG_Z * distance, DVec3::NEG_Z)
            };
            let found = find(&open_shot((0..60).map(camera).collect()), HEIGHT);
            assert_eq!(found.len(), 1, "{found:?}");
            assert!(matches!(found[0].kind, WarningKind::VelocityJump { .. }));
            assert!(found[0].frames.count() >= 60 / period - 2);
        }
    }

    #[test]
    fn corners_of_a_pan_are_jumps_of_the_angular_velocity() {
        // 10 degrees/s to the right, then as much to the left; and 10 degrees/s all the time.
        for (after, is_corner) in [(-1.0, true), (1.0, false)] {
            let camera = |i: u32| {
                let (before, after) = (i.min(40), after * f64::from(i.max(40) - 40));
                let (sin, cos) = ((f64::from(before) + after) * PI / 18.0 / FPS).sin_cos();
                still(DVec3::ZERO, DVec3::new(sin, 0.0, -cos))
            };
            let found = find(&open_shot((0..80).map(camera).collect()), HEIGHT);
            assert_eq!(found.len(), usize::from(is_corner), "{found:?}");
            for finding in found {
                let WarningKind::AngularVelocityJump { frame: 40, jump } = finding.kind else {
                    panic!("{finding:?}")
                };
                assert!((jump - PI / 9.0).abs() < 1e-9);
            }
        }
        // A change of 0.014 degrees/s is invisible.
        let slow = |i: u32| {
            still(
                DVec3::ZERO,
                DVec3::new(1e-5 * f64::from(i.min(40)), 0.0, -1.0),
            )
        };
        assert_eq!(find(&open_shot((0..80).map(slow).collect()), HEIGHT), []);
    }

    #[test]
    fn seams_of_closed_paths_are_found() {
        // Half a circle and a straight line back: a corner between them, and one where the path closes.
        let arc = |frame: u32| {
            let (sin, cos) = (PI * f64::from(frame) / 100.0).sin_cos();
            DVec3::new(cos, 0.0, sin)
        };
        let back = |frame: u32| DVec3::new(-1.0 + 2.0 * f64::from(frame) / 100.0, 0.0, 0.0);
        let positions = (0..100).map(arc).chain((0..100).map(back));
        let mut frames = open_shot(
            positions
                .map(|position| still(position, DVec3::NEG_Z))
                .collect(),
        );
        let found = find(&frames, HEIGHT);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].frames, FrameRuns::of([100]));
        frames.is_closed = true;
        let found = find(&frames, HEIGHT);
        assert_eq!(found.len(), 2);
        assert_eq!(found[1].frames, FrameRuns::of([0]));
        assert!(matches!(
            found[1].kind,
            WarningKind::VelocityJumpAtSeam { .. }
        ));
        // A cut there is intended.
        frames.cuts.push(199);
        assert_eq!(find(&frames, HEIGHT).len(), 1);
    }

    #[test]
    fn standing_cameras_have_no_warnings() {
        for count in [1, 2, 3, 50] {
            let cameras = vec![still(DVec3::splat(1e6), DVec3::X); count];
            assert_eq!(find(&open_shot(cameras), HEIGHT), []);
        }
    }
}
