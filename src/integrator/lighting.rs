//! What lights the surfaces of a scene.

use super::settings::IntegratorSettings;
use crate::light::PointLight;
use crate::scene::Scene;
use glam::Vec3;

/// What lights the surfaces of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lighting {
    /// Lights, emitters or a sky that is gathered; also where no surface reflects light but as a mirror.
    Shaded,
    /// Ambient light alone, the same everywhere.
    Flat,
    /// Nothing: the surfaces are black, and no samples tell how far off they are.
    Nothing,
}

impl Lighting {
    /// Of a scene with these settings, but for a headlight.
    pub fn of(scene: &Scene, settings: &IntegratorSettings) -> Lighting {
        let has_shapes = scene.triangle_count() + scene.sphere_count() > 0;
        if has_lights(scene) || !has_shapes {
            return Lighting::Shaded;
        }
        let shades = |id: usize| {
            let material = &scene.materials()[id];
            (Vec3::ONE - material.reflective) * (material.diffuse + material.specular) != Vec3::ZERO
        };
        let needs_light = !settings.gathers() && scene.used_materials().into_iter().any(shades);
        match (scene.ambient != Vec3::ZERO, scene.sky.is_black()) {
            (true, _) if needs_light => Lighting::Flat,
            (false, false) if needs_light => Lighting::Nothing,
            (false, true) => Lighting::Nothing,
            _ => Lighting::Shaded,
        }
    }
}

/// Whether anything shines but ambient light and the sky.
fn has_lights(scene: &Scene) -> bool {
    let shines = |light: &PointLight| light.intensity != Vec3::ZERO;
    scene.lights.iter().any(shines)
        || scene.suns.iter().any(|sun| sun.irradiance != Vec3::ZERO)
        || scene.has_emitters()
}
