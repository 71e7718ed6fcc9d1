//! Where the light of a scene comes from, and how much there is: for those who look at it.

use super::emitters::Source;
use super::names::SceneNames;
use super::resolved::Scene;
use crate::light::{Falloff, PointLight};
use glam::DVec3;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fmt;

/// Lights of one kind, and how much light they give.
#[derive(Clone, Debug, PartialEq)]
pub struct LightGroup {
    /// What they are.
    pub name: String,
    /// How many there are: lights, triangles and spheres that emit, or 1.
    pub count: usize,
    /// How much light they give, together.
    pub amount: LightAmount,
}

/// How much light there is, linear RGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightAmount {
    /// The power Φ, in W.
    Power(DVec3),
    /// The irradiance of surfaces that face it, in W/m².
    Irradiance(DVec3),
    /// The radiance, in W/(sr m²): of the background its mean, of lights with a constant falloff at any distance.
    Radiance(DVec3),
}

impl fmt::Display for LightGroup {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let LightGroup {
            name,
            count,
            amount,
        } = self;
        match count {
            1 => write!(f, "{name}: {amount}"),
            _ => write!(f, "{name}, {count} of them: {amount}"),
        }
    }
}

impl fmt::Display for LightAmount {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (color, unit) = match self {
            LightAmount::Power(color) => (color, "W"),
            LightAmount::Irradiance(color) => (color, "W/m²"),
            LightAmount::Radiance(color) => (color, "W/(sr m²)"),
        };
        let [red, green, blue] = color.to_array().map(three_digits);
        if red == green && green == blue {
            write!(f, "{red} {unit}")
        } else {
            write!(f, "({red}, {green}, {blue}) {unit}")
        }
    }
}

/// A number of three significant digits.
fn three_digits(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x) {
        let digits = x.log10().floor().max(-4.0);
        let places = (2.0 - digits).clamp(0.0, 5.0) as usize;
        let text = format!("{x:.places$}");
        match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
            false => text,
        }
    } else {
        format!("{x:.2e}")
    }
}

impl Scene {
    /// Where light comes from, in this order: point lights, suns, surfaces by their materials, the background, ambient
    /// light. What gives no light is left out.
    pub fn light_groups(&self, names: &SceneNames) -> Vec<LightGroup> {
        let mut groups = Vec::new();
        let mut add =
            |name: String, count: usize, amount: fn(DVec3) -> LightAmount, color: DVec3| {
                if color != DVec3::ZERO {
                    let amount = amount(color);
                    groups.push(LightGroup {
                        name,
                        count,
                        amount,
                    });
                }
            };
        for (falloff, amount) in [
            (Falloff::InverseSquare, LightAmount::Power as fn(DVec3) -> _),
            (Falloff::Constant, LightAmount::Radiance),
        ] {
            let lights = self.lights.iter().filter(|light| light.falloff == falloff);
            let color = |light: &PointLight| {
                let intensity = light.intensity.as_dvec3();
                match falloff {
                    Falloff::InverseSquare => intensity * light.cone.solid_angle(),
                    Falloff::Constant => intensity,
                }
            };
            let sum = lights.clone().map(color).sum();
            let name = match falloff {
                Falloff::InverseSquare => "point lights",
                Falloff::Constant => "point lights without falloff",
            };
            add(name.to_owned(), lights.count(), amount, sum);
        }
        let irradiance = self.suns.iter().map(|sun| sun.irradiance.as_dvec3()).sum();
        add(
            "suns".to_owned(),
            self.suns.len(),
            LightAmount::Irradiance,
            irradiance,
        );
        for (material, (count, power)) in self.power_of_materials() {
            let name = format!("surfaces of {}", names.material(material));
            add(name, count, LightAmount::Power, power);
        }
        let background = self.sky.mean_radiance().as_dvec3();
        add(
            "background".to_owned(),
            1,
            LightAmount::Radiance,
            background,
        );
        add(
            "ambient".to_owned(),
            1,
            LightAmount::Radiance,
            self.ambient.as_dvec3(),
        );
        groups
    }

    /// The number of shapes that emit and their power, by their first material.
    fn power_of_materials(&self) -> BTreeMap<usize, (usize, DVec3)> {
        let mut powers: BTreeMap<usize, (usize, DVec3)> = BTreeMap::new();
        let mut last = None;
        for emitter in &self.emitters.emitters {
            let Source::Primitive(primitive) = emitter.source else {
                continue;
            };
            let material = self.materials_of(primitive as usize)[0];
            let sides = match self.materials[material].emission.is_two_sided {
                true => 2.0,
                false => 1.0,
            };
            let (count, power) = powers.entry(material).or_default();
            // The pieces of a triangle follow each other.
            *count += usize::from(last != Some(primitive));
            last = Some(primitive);
            *power += PI * sides * emitter.shape.area() * emitter.radiance.as_dvec3();
        }
        powers
    }
}
