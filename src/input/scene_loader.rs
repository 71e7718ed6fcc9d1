//! Loads a scene file and every file that it names, checks the values and builds the scene.

use super::check::{Checker, MAX_MAGNITUDE, MAX_RADIANCE, MIN_SIZE, Triple};
use super::error::InputError;
use super::files::{InputFiles, relative_to};
use super::light_file::{FalloffFile, LightFile, PointFile, SpotFile, SunFile};
use super::mtl::{MAX_SHININESS, ObjTexture};
use super::obj::{self, ObjModel};
use super::scene_file::{
    MaterialFile, ModelFile, ObjectFile, SceneFile, SphereFile, TriangleFile, one,
};
use super::settings_file::Settings;
use super::{ron_file, sky_file, texture_file};
use crate::geometry::{Sphere, Transform};
use crate::light::{Cone, Falloff, PointLight, Sun};
use crate::material::{Emission, Material};
use crate::memory::{MemoryRoom, room};
use crate::scene::{MeshMaterial, MeshName, Scene, SceneBuilder, SceneNames, SourceMesh};
use glam::{DVec3, Vec2, Vec3};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// A scene and what else its file holds.
#[derive(Debug)]
pub struct SceneInput {
    /// The resolved scene.
    pub scene: Scene,
    /// The render settings of the file.
    pub settings: Settings,
    /// The number of objects in the file.
    pub object_count: usize,
    /// What its parts are called in its files.
    pub names: SceneNames,
    /// The files of the scene's textures, in their order.
    pub texture_files: Vec<PathBuf>,
    /// About what files ask for and do not get, and what may be a mistake.
    pub warnings: Vec<String>,
}

/// Loads a scene file and every file that it names.
pub fn load_scene(file: &Path, files: &mut InputFiles) -> Result<SceneInput, InputError> {
    let parsed: SceneFile = ron_file::parse(file, &files.read(file)?)?;
    let check = Checker { file };
    if let Err(error) = parsed.settings.check() {
        return check.refuse(&format!("settings.{}", error.key), error.message);
    }
    let sky = sky_file::load(&parsed.background, check, files)?;
    let mut loader = Loader {
        file,
        check,
        files,
        builder: SceneBuilder {
            ambient: check.color("ambient", parsed.ambient, MAX_RADIANCE)?,
            sky,
            ..SceneBuilder::default()
        },
        materials: HashMap::new(),
        textures: HashMap::new(),
        texture_files: Vec::new(),
        models: HashMap::new(),
        room: room(),
        triangle_count: 0,
        vertex_count: 0,
        grey: None,
        names: SceneNames::default(),
        warnings: Vec::new(),
    };
    for (name, material) in &parsed.materials {
        loader.add_material(name, material)?;
    }
    for (i, light) in parsed.lights.iter().enumerate() {
        loader.add_light(i, light)?;
    }
    for (i, object) in parsed.objects.iter().enumerate() {
        let key = format!("objects[{i}]");
        match object {
            ObjectFile::Sphere(sphere) => loader.add_sphere(&key, sphere)?,
            ObjectFile::Triangle(triangle) => loader.add_triangle(&key, i, triangle)?,
            ObjectFile::Model(model) => loader.add_model(&key, i, model)?,
        }
    }
    let Loader {
        builder,
        texture_files,
        names,
        mut warnings,
        ..
    } = loader;
    let (scene, dropped) = builder.build();
    if dropped > 0 {
        warnings.push(format!(
            "{}: {dropped} triangles have no area and are dropped",
            file.display()
        ));
    }
    Ok(SceneInput {
        scene,
        settings: parsed.settings,
        object_count: parsed.objects.len(),
        names,
        texture_files,
        warnings,
    })
}

/// What the parser calls parts without a name.
const UNNAMED: &str = "unnamed_object";

struct Loader<'a> {
    file: &'a Path,
    check: Checker<'a>,
    files: &'a mut InputFiles,
    builder: SceneBuilder,
    /// Indices of the scene file's materials by name.
    materials: HashMap<String, usize>,
    /// Indices of textures by file.
    textures: HashMap<PathBuf, usize>,
    texture_files: Vec<PathBuf>,
    /// Models that are loaded, by file and by whether with their own materials.
    models: HashMap<(PathBuf, bool), LoadedModel>,
    /// The memory that there was before the first model.
    room: Option<MemoryRoom>,
    /// Of all models so far, each copy counted.
    triangle_count: usize,
    vertex_count: usize,
    /// The material of faces without one, once there are any.
    grey: Option<usize>,
    names: SceneNames,
    warnings: Vec<String>,
}

#[derive(Clone)]
struct LoadedModel {
    model: Rc<ObjModel>,
    /// The scene's index of the model's first material; the others follow it.
    first_material: usize,
}

impl Loader<'_> {
    fn add_material(&mut self, name: &str, material: &MaterialFile) -> Result<(), InputError> {
        let key = |field: &str| format!("materials[\"{name}\"].{field}");
        let texture = match &material.texture {
            Some(texture) => {
                let file = relative_to(self.file, texture);
                Some(self.texture(file, self.file.to_owned(), &key("texture"))?)
            }
            None => None,
        };
        let default = if texture.is_some() {
            one()
        } else {
            Triple::default()
        };
        let check = self.check;
        let material = Material {
            diffuse: check.color(&key("diffuse"), material.diffuse.unwrap_or(default), 1.0)?,
            texture,
            specular: check.color(&key("specular"), material.specular, MAX_RADIANCE)?,
            shininess: check.range(&key("shininess"), material.shininess, 0.0, MAX_SHININESS)?
                as f32,
            reflective: check.color(&key("reflective"), material.reflective, 1.0)?,
            emission: self.emission(material, &key)?,
        };
        let number = self.new_material(material, format!("\"{name}\""));
        self.materials.insert(name.to_owned(), number);
        Ok(())
    }

    /// The emission of a material; `key` names its fields.
    fn emission(
        &mut self,
        material: &MaterialFile,
        key: &impl Fn(&str) -> String,
    ) -> Result<Emission, InputError> {
        let texture = match &material.emission_texture {
            Some(texture) => {
                let file = relative_to(self.file, texture);
                Some(self.texture(file, self.file.to_owned(), &key("emission_texture"))?)
            }
            None => None,
        };
        let default = match texture {
            Some(_) => one(),
            None => Triple::default(),
        };
        let radiance = material.emission.unwrap_or(default);
        Ok(Emission {
            radiance: self.check.color(&key("emission"), radiance, MAX_RADIANCE)?,
            texture,
            is_two_sided: material.two_sided,
        })
    }

    /// The material of an object with its own emitted radiance in place of the material's; texture and sides stay.
    fn with_emission(
        &mut self,
        key: &str,
        material: usize,
        emission: Option<Triple>,
    ) -> Result<usize, InputError> {
        let Some(radiance) = emission else {
            return Ok(material);
        };
        let key = format!("{key}.emission");
        let radiance = self.check.color(&key, radiance, MAX_RADIANCE)?;
        let mut copy = self.builder.materials[material].clone();
        copy.emission.radiance = radiance;
        let name = self.names.material(material);
        Ok(self.new_material(copy, name))
    }

    /// Adds a material that is called `name` in messages.
    fn new_material(&mut self, material: Material, name: String) -> usize {
        self.names.materials.push(name);
        self.builder.materials.push(material);
        self.builder.materials.len() - 1
    }

    fn material(&self, key: &str, name: &str) -> Result<usize, InputError> {
        if let Some(&number) = self.materials.get(name) {
            return Ok(number);
        }
        let mut names: Vec<&str> = self.materials.keys().map(String::as_str).collect();
        names.sort_unstable();
        let there = match names.is_empty() {
            true => "`materials` is empty".to_owned(),
            false => format!("`materials` has: {}", names.join(", ")),
        };
        self.check
            .refuse(key, format!("no material is called \"{name}\"; {there}"))
    }

    fn texture(&mut self, file: PathBuf, from: PathBuf, key: &str) -> Result<usize, InputError> {
        if let Some(&number) = self.textures.get(&file) {
            return Ok(number);
        }
        let bytes = self.files.read_reference(&file, &from, key)?;
        let (texture, notice) = texture_file::decode(&file, &bytes)?;
        if let Some(notice) = notice {
            self.warnings.push(format!("{}: {notice}", file.display()));
        }
        let number = self.builder.textures.len();
        self.builder.textures.push(texture);
        self.textures.insert(file.clone(), number);
        self.texture_files.push(file);
        Ok(number)
    }

    fn add_light(&mut self, index: usize, light: &LightFile) -> Result<(), InputError> {
        let key = |field: &str| format!("lights[{index}].{field}");
        match light {
            LightFile::Point(light) => self.add_point_light(index, light, &key),
            LightFile::Sun(sun) => self.add_sun(sun, &key),
        }
    }

    fn add_sun(&mut self, sun: &SunFile, key: &impl Fn(&str) -> String) -> Result<(), InputError> {
        let check = self.check;
        let direction = check.vector(&key("direction"), sun.direction)?;
        let Some(direction) = direction.try_normalize() else {
            return check.refuse(&key("direction"), "(0, 0, 0) is no direction");
        };
        let angle = check.range(&key("angle"), sun.angle, 0.0, 180.0)?;
        // 1 - cos(x / 2) = 2 sin(x / 4)^2 does not cancel.
        let sin = libm::sin(0.25 * angle.to_radians());
        self.builder.suns.push(Sun {
            to_sun: -direction.as_vec3(),
            irradiance: check.color(&key("irradiance"), sun.irradiance, MAX_RADIANCE)?,
            one_minus_cos: (2.0 * sin * sin) as f32,
        });
        Ok(())
    }

    fn add_point_light(
        &mut self,
        index: usize,
        light: &PointFile,
        key: &impl Fn(&str) -> String,
    ) -> Result<(), InputError> {
        let position = self.check.vector(&key("position"), light.position)?;
        let intensity = self
            .check
            .color(&key("intensity"), light.intensity, MAX_RADIANCE)?;
        let falloff = match light.falloff {
            FalloffFile::InverseSquare => Falloff::InverseSquare,
            FalloffFile::Constant => Falloff::Constant,
        };
        let radius = match light.radius {
            0.0 => 0.0,
            radius => self.check.positive(&key("radius"), radius)?,
        };
        if radius > 0.0 && falloff == Falloff::Constant {
            let message =
                "a light with a radius falls off by the inverse square; leave out one of the two";
            return self.check.refuse(&key("falloff"), message);
        }
        let cone = match &light.spot {
            Some(spot) => self.cone(spot, key)?,
            None => Cone::ALL,
        };
        let light = PointLight {
            position: Vec3::ZERO,
            intensity,
            falloff,
            cone,
            radius: radius as f32,
        };
        self.builder.lights.push((position, light));
        self.names.lights.push(format!("lights[{index}]"));
        Ok(())
    }

    fn cone(&self, spot: &SpotFile, key: &impl Fn(&str) -> String) -> Result<Cone, InputError> {
        let check = self.check;
        let direction = check.vector(&key("spot.direction"), spot.direction)?;
        let Some(axis) = direction.try_normalize() else {
            return check.refuse(&key("spot.direction"), "(0, 0, 0) is no direction");
        };
        let outer = check.range(&key("spot.outer"), spot.outer, 0.0, 180.0)?;
        let inner = check.range(&key("spot.inner"), spot.inner, 0.0, outer)?;
        Ok(Cone::new(
            axis.as_vec3(),
            inner.to_radians(),
            outer.to_radians(),
        ))
    }

    fn transform(
        &self,
        key: &str,
        scale: Triple,
        rotation: Triple,
        translation: Triple,
    ) -> Result<(Transform, DVec3), InputError> {
        let field = |name: &str| format!("{key}.{name}");
        let scale = self.check.vector(&field("scale"), scale)?;
        if scale.abs().min_element() < MIN_SIZE {
            return self
                .check
                .refuse(&field("scale"), format!("{scale}: no factor may be 0"));
        }
        let degrees = self.check.vector(&field("rotation"), rotation)?;
        let translation = self.check.vector(&field("translation"), translation)?;
        let angles = DVec3::from_array(degrees.to_array().map(f64::to_radians));
        Ok((Transform::new(scale, angles, translation), scale))
    }

    /// A point of an object, transformed to world space.
    fn placed(&self, key: &str, transform: &Transform, p: DVec3) -> Result<DVec3, InputError> {
        let placed = transform.point(p);
        if placed.abs().max_element() <= MAX_MAGNITUDE {
            return Ok(placed);
        }
        let message = format!("its scale and translation take {p} beyond {MAX_MAGNITUDE:e}");
        self.check.refuse(key, message)
    }

    fn add_sphere(&mut self, key: &str, sphere: &SphereFile) -> Result<(), InputError> {
        let (transform, scale) =
            self.transform(key, sphere.scale, sphere.rotation, sphere.translation)?;
        let factors = scale.abs();
        if factors.min_element() != factors.max_element() {
            self.warnings.push(format!(
                "{}: {key} has a non-uniform scale; it stays a sphere, with its radius scaled by the \
                 largest factor, {}",
                self.file.display(),
                factors.max_element()
            ));
        }
        let center = self.check.vector(&format!("{key}.center"), sphere.center)?;
        let name = format!("{key}.radius");
        let radius = self.check.positive(&name, sphere.radius)? * factors.max_element();
        let material = self.material(&format!("{key}.material"), &sphere.material)?;
        let material = self.with_emission(key, material, sphere.emission)?;
        let sphere = Sphere {
            center: self.placed(key, &transform, center)?,
            radius: self.check.positive(&name, radius)?,
            rotation: transform.rotation(),
        };
        self.builder.spheres.push((sphere, material));
        self.names.spheres.push(key.to_owned());
        Ok(())
    }

    fn add_triangle(
        &mut self,
        key: &str,
        object: usize,
        triangle: &TriangleFile,
    ) -> Result<(), InputError> {
        let (transform, _) =
            self.transform(key, triangle.scale, triangle.rotation, triangle.translation)?;
        let mut positions = Vec::new();
        for (i, vertex) in triangle.vertices.iter().enumerate() {
            let vertex = self
                .check
                .vector(&format!("{key}.vertices[{i}]"), *vertex)?;
            positions.push(self.placed(key, &transform, vertex)?);
        }
        let mut uvs = Vec::new();
        for (i, &(u, v)) in triangle.uvs.iter().flatten().enumerate() {
            let uv = self.check.vector(&format!("{key}.uvs[{i}]"), (u, v, 0.0))?;
            uvs.push(Vec2::new(uv.x as f32, uv.y as f32));
        }
        let material = match (&triangle.material, &triangle.vertex_materials) {
            (Some(name), None) => {
                let material = self.material(&format!("{key}.material"), name)?;
                MeshMaterial::Uniform(self.with_emission(key, material, triangle.emission)?)
            }
            (None, Some(names)) => {
                let mut materials = [0; 3];
                for (i, name) in names.iter().enumerate() {
                    let material = self.material(&format!("{key}.vertex_materials[{i}]"), name)?;
                    materials[i] = self.with_emission(key, material, triangle.emission)?;
                }
                MeshMaterial::PerVertex(transform.wound(materials))
            }
            _ => {
                let message = "give either `material` or `vertex_materials: [a, b, c]`";
                return self.check.refuse(key, message);
            }
        };
        let part = String::new();
        self.names.meshes.push(MeshName { object, part });
        self.builder.meshes.push(SourceMesh {
            positions,
            normals: Vec::new(),
            uvs,
            triangles: vec![transform.wound([0, 1, 2])],
            material,
        });
        Ok(())
    }

    fn add_model(&mut self, key: &str, object: usize, model: &ModelFile) -> Result<(), InputError> {
        let (transform, _) = self.transform(key, model.scale, model.rotation, model.translation)?;
        let reflective = match model.reflective {
            Some(rgb) => Some(self.check.color(&format!("{key}.reflective"), rgb, 1.0)?),
            None => None,
        };
        let emission = match model.emission {
            Some(rgb) => {
                let key = format!("{key}.emission");
                Some(self.check.color(&key, rgb, MAX_RADIANCE)?)
            }
            None => None,
        };
        let own = match &model.material {
            Some(name) => Some(self.material(&format!("{key}.material"), name)?),
            None => None,
        };
        let loaded = self.model(key, &model.file, own.is_none())?;
        self.check_room(key, &loaded.model)?;
        // Copies of materials with what the object has of its own, by the index of the original.
        let mut copies: HashMap<usize, usize> = HashMap::new();
        for part in &loaded.model.parts {
            let mut material = match (own, part.material) {
                (Some(own), _) => own,
                (None, Some(index)) => loaded.first_material + index,
                (None, None) => self.grey(),
            };
            if reflective.is_some() || emission.is_some() {
                material = *copies.entry(material).or_insert_with(|| {
                    let mut copy = self.builder.materials[material].clone();
                    copy.reflective = reflective.unwrap_or(copy.reflective);
                    copy.emission.radiance = emission.unwrap_or(copy.emission.radiance);
                    let name = self.names.material(material);
                    self.new_material(copy, name)
                });
            }
            let part_name = match part.name.as_str() {
                "" | UNNAMED => format!(" ({})", model.file),
                name => format!(" ({}: {name})", model.file),
            };
            self.names.meshes.push(MeshName {
                object,
                part: part_name,
            });
            let positions = part.positions.iter();
            let positions = positions.map(|&p| self.placed(key, &transform, p));
            self.builder.meshes.push(SourceMesh {
                positions: positions.collect::<Result<_, _>>()?,
                normals: part
                    .normals
                    .iter()
                    .map(|&n| transform.normal(n).as_vec3())
                    .collect(),
                uvs: part.uvs.clone(),
                triangles: part.triangles.iter().map(|&t| transform.wound(t)).collect(),
                material: MeshMaterial::Uniform(material),
            });
        }
        Ok(())
    }

    /// Checks that the scene still fits into memory with this model: copies add up.
    fn check_room(&mut self, key: &str, model: &ObjModel) -> Result<(), InputError> {
        self.triangle_count += model
            .parts
            .iter()
            .map(|part| part.triangles.len())
            .sum::<usize>();
        self.vertex_count += model
            .parts
            .iter()
            .map(|part| part.positions.len())
            .sum::<usize>();
        let need = SceneBuilder::memory(self.triangle_count, self.vertex_count);
        let what = format!(
            "{}: {key}: a scene of {} triangles",
            self.file.display(),
            self.triangle_count
        );
        match self.room {
            Some(room) => Ok(room.check(&what, need, "use fewer copies or smaller models")?),
            None => Ok(()),
        }
    }

    fn model(
        &mut self,
        key: &str,
        name: &str,
        with_materials: bool,
    ) -> Result<LoadedModel, InputError> {
        let file = relative_to(self.file, name);
        let id = (file.clone(), with_materials);
        if let Some(loaded) = self.models.get(&id) {
            return Ok(loaded.clone());
        }
        let bytes = self
            .files
            .read_reference(&file, self.file, &format!("{key}.file"))?;
        let mut model = obj::load(&file, &bytes, with_materials, self.files)?;
        self.warnings.append(&mut model.warnings);
        let mut resolved = Vec::new();
        for material in &model.materials {
            let mut texture = |texture: &Option<ObjTexture>| {
                let load = |t: &ObjTexture| self.texture(t.file.clone(), t.library.clone(), &t.key);
                texture.as_ref().map(load).transpose()
            };
            let emission_texture = texture(&material.emission_texture)?;
            let texture = texture(&material.texture)?;
            resolved.push(Material {
                diffuse: material.diffuse,
                texture,
                specular: material.specular,
                shininess: material.shininess,
                reflective: material.reflective,
                emission: Emission {
                    radiance: material.emission,
                    texture: emission_texture,
                    is_two_sided: false,
                },
            });
        }
        let first_material = self.builder.materials.len();
        let names = model.materials.iter().map(|material| material.name.clone());
        self.names.materials.extend(names);
        self.builder.materials.append(&mut resolved);
        let loaded = LoadedModel {
            model: Rc::new(model),
            first_material,
        };
        self.models.insert(id, loaded.clone());
        Ok(loaded)
    }

    fn grey(&mut self) -> usize {
        if let Some(number) = self.grey {
            return number;
        }
        let grey = Material::lambert(Vec3::splat(0.8));
        let number = self.new_material(grey, "grey, of faces without one".to_owned());
        self.grey = Some(number);
        number
    }
}
