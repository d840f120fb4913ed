"""Writes a scene as spherule's TOML."""

import pathlib

from images import write_sky


def triple(values):
    return "[" + ", ".join(f"{value:.9g}" for value in values) + "]"


def image_and_camera(scene, width, height):
    camera = scene.camera
    lines = ["[image]", f"width = {width}", f"height = {height}", f"max_bounces = {scene.max_bounces}"]
    if scene.caustics:
        lines.append("caustics = true")
    lines += ["background = [0, 0, 0]", "", "[camera]"]
    lines += [f"eye = {triple(camera.eye)}", f"target = {triple(camera.target)}"]
    lines += [f"vertical_fov = {camera.vertical_fov}"]
    if camera.aperture:
        lines += [f"aperture = {camera.aperture}", f"focus_distance = {camera.focus_distance}"]
    return [*lines, ""]


def material(name, of):
    lines = [f"[materials.{name}]"]
    if of.kind == "glass":
        return [*lines, 'kind = "glass"', f"index = {of.index}", ""]
    kind = "metal" if of.kind == "mirror" else of.kind
    return [*lines, f'kind = "{kind}"', f"color = {triple(of.color)}", ""]


def sphere(of):
    return [
        "[[sphere]]",
        f"center = {triple(of.center)}",
        f"radius = {of.radius:.9g}",
        f'material = "{of.material}"',
        "",
    ]


def surroundings(scene, folder):
    lines = []
    if scene.environment:
        image = f"{scene.name}-spherule.exr"
        write_sky(scene.environment, folder / image, "spherule")
        lines += ["[sky]", f'image = "{image}"', ""]
    elif any(scene.sky):
        lines += ["[sky]", f"zenith = {triple(scene.sky)}", ""]
    if scene.fog:
        fog = scene.fog
        lines += ["[fog]", f"extinction = {fog.extinction}", f"albedo = {triple(fog.albedo)}"]
        lines += [f"anisotropy = {fog.anisotropy}", f"center = {triple(fog.center)}", f"radius = {fog.radius}", ""]
    return lines


def write(scene, folder, width, height):
    """Writes the scene, and the image of its sky, into the folder; returns the scene's path."""
    lines = image_and_camera(scene, width, height) + surroundings(scene, folder)
    for name, of in scene.materials.items():
        lines += material(name, of)
    for of in scene.spheres:
        lines += sphere(of)
    path = pathlib.Path(folder) / f"{scene.name}.toml"
    path.write_text("\n".join(lines))
    return path
