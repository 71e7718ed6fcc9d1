//! Lights without intensity, and scenes without light.

use super::SceneWarning;
use crate::integrator::{IntegratorSettings, Lighting};
use crate::scene::{Scene, SceneNames};
use glam::Vec3;

/// What a scene without lights lacks in this integrator, if it does.
fn unlit(scene: &Scene, integrator: &IntegratorSettings) -> Option<SceneWarning> {
    match Lighting::of(scene, integrator) {
        Lighting::Shaded => None,
        Lighting::Flat => Some(SceneWarning::AmbientOnly),
        Lighting::Nothing if scene.sky.is_black() => Some(SceneWarning::Black),
        Lighting::Nothing => Some(SceneWarning::BlackSurfaces),
    }
}

pub(super) fn find(
    scene: &Scene,
    names: &SceneNames,
    integrator: &IntegratorSettings,
) -> Vec<SceneWarning> {
    let is_dark = |light: usize| scene.lights[light].intensity == Vec3::ZERO;
    let dark: Vec<usize> = (0..scene.lights.len()).filter(|&i| is_dark(i)).collect();
    let unlit = unlit(scene, integrator);
    let dark = (!dark.is_empty()).then(|| SceneWarning::DarkLights {
        lights: dark.into_iter().map(|light| names.light(light)).collect(),
    });
    dark.into_iter().chain(unlit).collect()
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{hall, lamp, lit_scene};
    use super::*;
    use crate::light::Sky;
    use crate::material::Material;
    use crate::scene::SceneBuilder;
    use glam::DVec3;

    const RAY_TRACED: IntegratorSettings = IntegratorSettings::Whitted { bounces: 4 };
    const CACHED: IntegratorSettings = IntegratorSettings::Cached { bounces: 4 };

    #[test]
    fn scenes_without_light_are_black_only_if_nothing_else_shines() {
        let found = |ambient: f32, background: f32, intensities: &[f32], integrator| {
            let lights = intensities.iter().map(|&i| lamp(DVec3::Y, i));
            let mut scene = lit_scene(vec![hall()], &[], lights.collect());
            scene.ambient = Vec3::splat(ambient);
            scene.sky = Sky::Uniform(Vec3::splat(background));
            find(&scene, &SceneNames::default(), integrator)
        };
        let dark = |lights: &[usize]| SceneWarning::DarkLights {
            lights: lights
                .iter()
                .map(|light| format!("light {light}"))
                .collect(),
        };
        for integrator in [&RAY_TRACED, &CACHED] {
            assert_eq!(found(0.0, 0.0, &[], integrator), [SceneWarning::Black]);
            assert_eq!(found(0.0, 0.0, &[1.0], integrator), []);
            assert_eq!(found(0.0, 0.0, &[1.0, 0.0], integrator), [dark(&[1])]);
            let both = [dark(&[0, 1]), SceneWarning::Black];
            assert_eq!(found(0.0, 0.0, &[0.0; 2], integrator), both);
        }
        // A sky lights surfaces only where it is gathered, and ambient light is flat only where nothing is.
        assert_eq!(
            found(0.0, 1.0, &[], &RAY_TRACED),
            [SceneWarning::BlackSurfaces]
        );
        assert_eq!(found(0.0, 1.0, &[], &CACHED), []);
        let direct = IntegratorSettings::Cached { bounces: 0 };
        assert_eq!(found(0.0, 1.0, &[], &direct), [SceneWarning::BlackSurfaces]);
        assert_eq!(
            found(1.0, 0.0, &[], &RAY_TRACED),
            [SceneWarning::AmbientOnly]
        );
        assert_eq!(found(1.0, 0.0, &[], &CACHED), []);
    }

    #[test]
    fn mirrors_need_no_light() {
        let builder = SceneBuilder {
            sky: Sky::Uniform(Vec3::ONE),
            materials: vec![Material {
                reflective: Vec3::ONE,
                ..Material::lambert(Vec3::ONE)
            }],
            meshes: vec![hall()],
            ..SceneBuilder::default()
        };
        assert_eq!(
            find(&builder.build().0, &SceneNames::default(), &RAY_TRACED),
            []
        );
    }

    #[test]
    fn a_scene_of_background_alone_needs_no_light() {
        let scene = lit_scene(vec![], &[], vec![]);
        assert_eq!(find(&scene, &SceneNames::default(), &RAY_TRACED), []);
    }
}
