#!/usr/bin/env python3
"""Renders the references of tests/light/mitsuba.rs with Mitsuba 3.9.1 (pip install mitsuba==3.9.1 numpy; LLVM).

    tests/reference/make_mitsuba.py [NAME...]

Each becomes tests/reference/NAME.exr, 40 columns wide. From top to bottom, for 0, 1 and 4 bounces: 30 rows
of means over independent renderings, then 30 rows of their standard errors.
"""
import sys
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

HERE = Path(__file__).parent
WIDTH, HEIGHT = 40, 30
BOUNCES = (0, 1, 4)
RENDERINGS, SAMPLES = 32, 4096

WHITE, RED, GREEN = (0.725, 0.71, 0.68), (0.63, 0.065, 0.05), (0.14, 0.45, 0.091)


class Blend(mi.BSDF):
    """diffuse * (1 - mirror) + mirror * (a perfect mirror).

    Mitsuba's own `blendbsdf` divides what a mirror reflects by the density of both of its parts, of which
    the mirror's is a delta function, and so loses the fraction (1 - w) cos / pi / (w + (1 - w) cos / pi) of it.
    """

    def __init__(self, properties):
        super().__init__(properties)
        self.diffuse, self.mirror = properties["diffuse"], properties["mirror"]
        front = mi.BSDFFlags.FrontSide
        self.m_components = [mi.BSDFFlags.DiffuseReflection | front, mi.BSDFFlags.DeltaReflection | front]
        self.m_flags = self.m_components[0] | self.m_components[1]

    def sample(self, context, hit, sample1, sample2, active=True):
        by_mirror = sample1 < self.mirror
        result = dr.zeros(mi.BSDFSample3f)
        result.wo = dr.select(by_mirror, mi.reflect(hit.wi), mi.warp.square_to_cosine_hemisphere(sample2))
        result.pdf = dr.select(by_mirror, self.mirror, self.pdf(context, hit, result.wo, active))
        result.eta = 1.0
        result.sampled_component = dr.select(by_mirror, mi.UInt32(1), mi.UInt32(0))
        result.sampled_type = dr.select(
            by_mirror, mi.UInt32(+mi.BSDFFlags.DeltaReflection), mi.UInt32(+mi.BSDFFlags.DiffuseReflection))
        weight = dr.select(by_mirror, mi.Color3f(1.0), mi.Color3f(self.diffuse))
        return result, weight & (active & (mi.Frame3f.cos_theta(hit.wi) > 0))

    def pdf(self, context, hit, wo, active=True):
        front = active & (mi.Frame3f.cos_theta(hit.wi) > 0) & (mi.Frame3f.cos_theta(wo) > 0)
        return dr.select(front, (1 - self.mirror) * mi.warp.square_to_cosine_hemisphere_pdf(wo), 0)

    def eval(self, context, hit, wo, active=True):
        return mi.Color3f(self.diffuse) * self.pdf(context, hit, wo, active)

    def eval_pdf(self, context, hit, wo, active=True):
        return self.eval(context, hit, wo, active), self.pdf(context, hit, wo, active)


mi.register_bsdf("blend", Blend)


def rgb(color):
    return {"type": "rgb", "value": list(color)}


def diffuse(color):
    return {"type": "diffuse", "reflectance": rgb(color)}


def area(radiance):
    return {"type": "area", "radiance": rgb(radiance)}


def matte(color):
    return {"type": "twosided", "bsdf": diffuse(color)}


def wall(name, corners, color, radiance=None):
    """A convex polygon. It emits to the side from which its corners are counter-clockwise."""
    properties = mi.Properties()
    properties["face_normals"] = True
    properties["bsdf"] = mi.load_dict(matte(color))
    if radiance:
        properties["emitter"] = mi.load_dict(area(radiance))
    faces = [(0, i, i + 1) for i in range(1, len(corners) - 1)]
    mesh = mi.Mesh(name, len(corners), len(faces), props=properties)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = np.ravel(np.asarray(corners, dtype=np.float32))
    parameters["faces"] = np.ravel(np.asarray(faces, dtype=np.uint32))
    parameters.update()
    return mesh


def walls():
    return {
        "floor": wall("floor", [(-1, -1, 1), (1, -1, 1), (1, -1, -1), (-1, -1, -1)], WHITE),
        "ceiling": wall("ceiling", [(-1, 1, -1), (1, 1, -1), (1, 1, 1), (-1, 1, 1)], WHITE),
        "back": wall("back", [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1)], WHITE),
        "left": wall("left", [(-1, -1, 1), (-1, -1, -1), (-1, 1, -1), (-1, 1, 1)], RED),
        "right": wall("right", [(1, -1, -1), (1, -1, 1), (1, 1, 1), (1, 1, -1)], GREEN),
    }


def room():
    return walls() | {
        "light1": {"type": "point", "position": [-0.5, 0.8, 0.3], "intensity": rgb([0.7] * 3)},
        "light2": {"type": "point", "position": [0.5, 0.8, 0.3], "intensity": rgb([0.5] * 3)},
    }


def sphere(center, radius, bsdf):
    return {"type": "sphere", "center": list(center), "radius": radius, "bsdf": bsdf}


def camera(position, target, degrees):
    return {
        "type": "perspective", "fov": degrees, "fov_axis": "y",
        "to_world": mi.ScalarTransform4f().look_at(origin=position, target=target, up=[0, 1, 0]),
        "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT},
    }


def test3():
    """scenes/test3.ron, frame 0 of paths/test3.ron."""
    return room() | {
        "mirror": sphere((0.35, -0.5, -0.2), 0.5, {"type": "blend", "diffuse": [0.7] * 3, "mirror": 0.8}),
        "olive": sphere((-0.45, -0.65, 0.2), 0.35, diffuse((0.6, 0.6, 0.2))),
        "sensor": camera([-0.5, 0, 3], [0, -0.1, 0], 45),
    }


def mirror():
    """test3 with a sphere that is nothing but a mirror, from close by."""
    metal = {"type": "conductor", "material": "none", "specular_reflectance": rgb([0.8] * 3)}
    return room() | {
        "mirror": sphere((0.35, -0.5, -0.2), 0.5, metal),
        "olive": sphere((-0.45, -0.65, 0.2), 0.35, diffuse((0.6, 0.6, 0.2))),
        "sensor": camera([0, -0.2, 1.5], [0.3, -0.5, -0.2], 45),
    }


def mesh():
    """The room of test3 with a model of interpolated normals in it."""
    to_world = mi.ScalarTransform4f().translate([0, -1.2, 0]).scale(1.5)
    return room() | {
        "knot": {"type": "obj", "filename": str(HERE / "../../scenes/models/knot.obj"), "to_world": to_world,
                 "bsdf": matte((0.6, 0.6, 0.2))},
        "sensor": camera([-0.5, 0, 3], [0, -0.4, 0], 34),
    }


def emitters():
    """The room of test3, lit by a square, a sphere and a triangle that emits on both sides."""
    panel = np.array([(0.05, -0.8, -0.6), (0.8, -0.8, -0.35), (0.5, 0.1, -0.5)])
    normal = np.cross(panel[1] - panel[0], panel[2] - panel[0])
    # A side each, so close that rounding hides the gap.
    apart = 1e-5 * normal / np.linalg.norm(normal)
    lamp = [(-0.3, 0.95, -0.3), (0.3, 0.95, -0.3), (0.3, 0.95, 0.3), (-0.3, 0.95, 0.3)]
    return walls() | {
        "lamp": wall("lamp", lamp, (0, 0, 0), (6, 6, 5)),
        "front": wall("front", panel + apart, (0.3, 0.3, 0.3), (0.5, 1, 2)),
        "behind": wall("behind", panel[::-1] - apart, (0.3, 0.3, 0.3), (0.5, 1, 2)),
        "bulb": sphere((0.4, -0.6, 0.35), 0.12, diffuse((0, 0, 0))) | {"emitter": area((3, 1, 1))},
        "olive": sphere((-0.45, -0.65, 0.2), 0.35, diffuse((0.6, 0.6, 0.2))),
        "sensor": camera([-0.5, 0, 3], [0, -0.1, 0], 45),
    }


def sun_and_sky():
    """A wall and two spheres in the open."""
    return {
        "floor": wall("floor", [(-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3)], (0.6, 0.55, 0.5)),
        "wall": wall("wall", [(-1.8, 0, -1), (2.4, 0, -1), (2.4, 1.8, -1), (-1.8, 1.8, -1)], (0.8, 0.4, 0.3)),
        "white": sphere((0.5, 0.5, 0), 0.5, diffuse((0.8, 0.8, 0.8))),
        "olive": sphere((-0.6, 0.35, 0.4), 0.35, diffuse((0.6, 0.6, 0.2))),
        "sun": {"type": "directional", "direction": [-0.5, -1, -0.6], "irradiance": rgb((3, 2.7, 2.2))},
        "sky": {"type": "constant", "radiance": rgb((0.3, 0.5, 1))},
        "sensor": camera([0.3, 1.6, 3.2], [0.1, 0.35, 0], 45),
    }


def render(scene, bounces):
    """Mean and standard error. The sky, which is found by bounces only, lights one surface of a path less."""
    seed = bounces * RENDERINGS
    if "sky" not in scene:
        return render_depth(scene, bounces + 2, seed)
    by_sun = {name: part for name, part in scene.items() if name != "sky"}
    by_sky = {name: part for name, part in scene.items() if name != "sun"}
    sun, sun_error = render_depth(by_sun, bounces + 2, seed)
    sky, sky_error = render_depth(by_sky, bounces + 1, seed + 1000)
    return sun + sky, np.hypot(sun_error, sky_error)


def render_depth(scene, depth, seed):
    """Mean and standard error of independent renderings, with all camera rays through the pixels' middles."""
    integrator = {"type": "path", "max_depth": depth, "rr_depth": 1000}
    scene = mi.load_dict({"type": "scene", "integrator": integrator} | scene)
    sampler = mi.load_dict({"type": "independent"})
    pixel = dr.arange(mi.UInt32, WIDTH * HEIGHT * SAMPLES) // SAMPLES
    middle = mi.Point2f((pixel % WIDTH + 0.5) / WIDTH, (pixel // WIDTH + 0.5) / HEIGHT)
    rays, _ = scene.sensors()[0].sample_ray_differential(0, 0, middle, 0)
    pictures = []
    for number in range(RENDERINGS):
        sampler.seed(seed + number, dr.width(pixel))
        radiance, _, _ = scene.integrator().sample(scene, sampler, rays)
        radiance = np.array(radiance, dtype=np.float64).reshape(3, HEIGHT, WIDTH, SAMPLES)
        pictures.append(np.moveaxis(radiance.mean(axis=3), 0, 2))
    return np.mean(pictures, axis=0), np.std(pictures, axis=0, ddof=1) / np.sqrt(RENDERINGS)


SCENES = {"test3": test3, "mirror": mirror, "mesh": mesh, "emitters": emitters, "sun_and_sky": sun_and_sky}
for name in sys.argv[1:] or SCENES:
    parts = [part for bounces in BOUNCES for part in render(SCENES[name](), bounces)]
    picture = mi.Bitmap(np.concatenate(parts).astype(np.float32))
    picture.write(str(HERE / f"{name}.exr"))
