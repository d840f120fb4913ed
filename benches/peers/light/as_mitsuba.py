"""Makes a scene into the dictionary that Mitsuba loads. The variant must be set."""

import mitsuba as mi

from images import write_sky


def rgb(values):
    return {"type": "rgb", "value": [float(value) for value in values]}


def bsdf(of):
    if of.kind == "diffuse":
        return {"type": "diffuse", "reflectance": rgb(of.color)}
    if of.kind == "mirror":
        return {"type": "conductor", "material": "none"}
    return {"type": "dielectric", "int_ior": of.index, "ext_ior": 1.0}


def shape(of, material):
    found = {"type": "sphere", "center": list(of.center), "radius": of.radius}
    if material.kind == "emissive":
        return found | {"emitter": {"type": "area", "radiance": rgb(material.color)}}
    return found | {"bsdf": {"type": "ref", "id": of.material}}


def sensor(scene, width, height, sampler, samples):
    camera = scene.camera
    look = mi.ScalarTransform4f().look_at(origin=list(camera.eye), target=list(camera.target), up=[0, 1, 0])
    found = {
        "type": "perspective",
        "to_world": look,
        "fov": camera.vertical_fov,
        "fov_axis": "y",
        "film": {
            "type": "hdrfilm",
            "width": width,
            "height": height,
            "pixel_format": "rgb",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        },
        "sampler": {"type": sampler, "sample_count": samples},
    }
    if camera.aperture:
        found |= {"type": "thinlens", "aperture_radius": camera.aperture / 2, "focus_distance": camera.focus_distance}
    if scene.fog:
        found["medium"] = {"type": "ref", "id": "fog"}
    return found


def fog_parts(fog):
    medium = {
        "type": "homogeneous",
        "albedo": rgb(fog.albedo),
        "sigma_t": fog.extinction,
        "phase": {"type": "hg", "g": fog.anisotropy},
    }
    ball = {
        "type": "sphere",
        "center": list(fog.center),
        "radius": fog.radius,
        "bsdf": {"type": "null"},
        "interior": {"type": "ref", "id": "fog"},
    }
    return {"fog": medium, "fog_ball": ball}


def surroundings(scene, folder):
    if scene.environment:
        path = folder / f"{scene.name}-mitsuba.exr"
        write_sky(scene.environment, path, "mitsuba")
        turn = mi.ScalarTransform4f().rotate([0, 1, 0], 180)
        return {"sky": {"type": "envmap", "filename": str(path), "to_world": turn}}
    if any(scene.sky):
        return {"sky": {"type": "constant", "radiance": rgb(scene.sky)}}
    return {}


def load(scene, folder, width, height, samplers, samples):
    """Mitsuba's scene, with one sensor for each sampler, in their order."""
    # A path of `max_bounces` = 0 has two segments: to the surface, and to the light.
    integrator = {"type": "volpath" if scene.fog else "path", "max_depth": scene.max_bounces + 2}
    found = {"type": "scene", "integrator": integrator}
    if scene.fog:
        found |= fog_parts(scene.fog)
    found |= surroundings(scene, folder)
    for name, of in scene.materials.items():
        if of.kind != "emissive":
            found[name] = bsdf(of) | {"id": name}
    for i, of in enumerate(scene.spheres):
        found[f"sphere_{i}"] = shape(of, scene.materials[of.material])
    for i, sampler in enumerate(samplers):
        found[f"sensor_{i}"] = sensor(scene, width, height, sampler, samples)
    return mi.load_dict(found)
