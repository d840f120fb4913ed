//! Tests of reading scenes, and of errors with their places.

use glam::Vec3;
use spherule_kernel::Sphere;

use super::*;
use crate::error::Error;

const GOOD: &str = r#"
[image]
width = 4
height = 3
background = [0, 0.5, 1]

[camera]
eye = [0, 0, 0]
target = [0, 0, -1]
vertical_fov = 90

[materials.red]
kind = "diffuse"
color = [1, 0, 0]

[[sphere]]
center = [0, 0, -3]
radius = 0.5
material = "red"

[[sphere]]
center = [0, -100.5, -3]
radius = 100
"#;

fn read(text: &str) -> Result<Scene> {
    parse(Path::new("test.toml"), text.into())
}

#[test]
fn a_whole_scene_is_read() {
    let scene = read(GOOD).expect("a scene");
    assert_eq!((scene.width, scene.height), (4, 3));
    assert_eq!(scene.background, Vec3::new(0.0, 0.5, 1.0));
    assert_eq!(
        scene.world.spheres[1],
        Sphere::new(Vec3::new(0.0, -100.5, -3.0), 100.0)
    );
    assert_eq!(scene.world.materials[0], Material::diffuse(Vec3::X));
    assert_eq!(scene.world.material_ids, [0, 1]);
    assert_eq!(scene.view.expect("a view").vertical_fov, 90.0);
}

/// Text in which `{x}` stands for the coordinate x of something, moved by `by`.
fn moved(text: &str, by: f64) -> String {
    let mut pieces = text.split(['{', '}']);
    let mut moved = pieces.next().expect("a piece").to_owned();
    while let (Some(number), Some(text)) = (pieces.next(), pieces.next()) {
        let number: f64 = number.parse().expect("a coordinate");
        moved += &format!("{:.3}{text}", number + by);
    }
    moved
}

const SPHERES: &str = "
[[sphere]]
center = [{0.123}, {0.7}, {-0.456}]
radius = 0.5

[[sphere]]
center = [{0.25}, {-99.8}, {0}]
radius = 100
";

const SURROUNDINGS: &str = "
[camera]
eye = [{1.1}, {2.3}, {4.7}]
target = [{0.1}, {0.2}, {-0.3}]

[[light]]
position = [{2.001}, {5}, {3.3}]
intensity = [1, 1, 1]

[fog]
extinction = 0.1
center = [{0.017}, {0.019}, {0.023}]
radius = 3
";

/// A coordinate of 10⁶ is 0.06 off in 32-bit floats.
#[test]
fn far_scenes_keep_their_shape() {
    let around_origin = SURROUNDINGS.replace("center = [{0.017}, {0.019}, {0.023}]", "");
    let far = format!("{}{SPHERES}", moved(&around_origin, 1e6));
    let fog = read(&moved(&far, 1e6)).expect("a scene").fog.expect("fog");
    assert_eq!(
        fog.medium.center,
        Vec3::splat(-1e6),
        "around the file's origin"
    );
    for text in [SPHERES.to_owned(), format!("{SURROUNDINGS}{SPHERES}")] {
        let near = read(&moved(&text, 0.0)).expect("a scene");
        let far = read(&moved(&text, 1e6)).expect("a scene");
        assert_eq!(near.origin, DVec3::ZERO);
        assert!(far.origin.distance(DVec3::splat(1e6)) < 1000.0);
        let shift = (DVec3::splat(1e6) - far.origin).as_vec3();
        let is_near = |a: Vec3, b: Vec3| (a - b - shift).abs().max_element() < 3e-5;
        for (a, b) in far.world.spheres.iter().zip(&near.world.spheres) {
            assert!(is_near(a.center(), b.center()) && a.radius() == b.radius());
        }
        assert_eq!(far.view.is_some(), near.view.is_some());
        let (a, b) = (far.view_or_framed(), near.view_or_framed());
        assert!(
            is_near(a.eye, b.eye) && is_near(a.target, b.target),
            "{a:?} {b:?}"
        );
        for (a, b) in far.lights.iter().zip(&near.lights) {
            assert!(is_near(a.position, b.position), "{a:?} {b:?}");
        }
        if let (Some(a), Some(b)) = (far.fog, near.fog) {
            assert!(is_near(a.medium.center, b.medium.center), "{a:?} {b:?}");
        }
    }
}

/// A sphere that would be out of range around another origin keeps the scene where it is.
#[test]
fn the_largest_scenes_stay() {
    let text = "[camera]
eye = [9.9e17, 0, 0]
target = [9.9e17, 0, 1e14]

[[sphere]]
center = [-9.9e17, 0, 0]
radius = 1
";
    let scene = read(text).expect("a scene");
    assert_eq!(scene.origin, DVec3::ZERO);
    assert_eq!(scene.world.spheres[0].center().x, -9.9e17);
    let without = read(&text.replace("-9.9e17", "9.9e17")).expect("a scene");
    assert_ne!(without.origin, DVec3::ZERO);
}

/// Each error, the line on which it must be found, and a word of the message.
#[test]
#[expect(clippy::too_many_lines, reason = "one table, an entry a mistake")]
fn each_mistake_is_refused_at_its_line() {
    let cases = [
        ("width = 4", "width = 0", 3, "width = 0"),
        (
            "width = 4",
            "width = 4.5",
            3,
            "width is 4.5, not a whole number",
        ),
        (
            "width = 4",
            "width = 99999999999999999999",
            3,
            "width = 1e20",
        ),
        (
            "width = 4",
            "width = [4]",
            3,
            "width is a list, not a whole",
        ),
        ("width = 4", "wdith = 4", 3, "unknown field"),
        ("width = 4", "width = 99999", 3, "99999"),
        ("[0, 0.5, 1]", "[0, -0.5, 1]", 5, "below zero"),
        ("[0, 0.5, 1]", "[0, 0.5]", 5, "2 numbers"),
        ("[camera]", "[lens]", 7, "unknown field"),
        (
            "eye = [0, 0, 0]",
            "eye = [0, nan, 0]",
            8,
            "eye is not finite",
        ),
        (
            "eye = [0, 0, 0]",
            "eye = [0, inf, 0]",
            8,
            "eye is not finite",
        ),
        (
            "eye = [0, 0, 0]",
            "eye = [0, 1e39, 0]",
            8,
            "eye is not finite",
        ),
        ("eye = [0, 0, 0]", "eye = [0, 2e18, 0]", 8, "too large"),
        ("eye = [0, 0, 0]", "eye = [0, 0, 0, 0]", 8, "4 numbers"),
        ("eye = [0, 0, 0]", "", 7, "missing field `eye`"),
        ("target = [0, 0, -1]", "target = [0, 0, 0]", 9, "same point"),
        (
            "target = [0, 0, -1]",
            "target = [0, 9, 0]",
            7,
            "along the view",
        ),
        (
            "vertical_fov = 90",
            "vertical_fov = 180",
            10,
            "vertical_fov = 180",
        ),
        (
            "vertical_fov = 90",
            "vertical_fov = nan",
            10,
            "vertical_fov = NaN",
        ),
        (
            "\"diffuse\"",
            "\"mirror\"",
            13,
            "there is no kind \"mirror\"",
        ),
        ("color = [1, 0, 0]", "color = [1.5, 0, 0]", 14, "above one"),
        ("radius = 0.5", "radius = 0", 18, "radius = 0"),
        ("radius = 0.5", "radius = -1", 18, "radius = -1"),
        ("radius = 0.5", "radius = nan", 18, "radius = NaN"),
        ("radius = 0.5", "radius = 1e-60", 18, "radius = 1e-60"),
        (
            "radius = 0.5",
            "radius = \"0.5\"",
            18,
            "radius is the text \"0.5\", not a number",
        ),
        ("radius = 0.5", "radius = 1e300", 18, "radius = 1e300"),
        (
            "center = [0, 0, -3]",
            "center = [0, true, -3]",
            17,
            "center holds true, not three numbers",
        ),
        (
            "center = [0, 0, -3]",
            "center = {x = 0}",
            17,
            "center is a table, not a list of three numbers",
        ),
        (
            "center = [0, 0, -3]",
            "center = [1]",
            17,
            "center has 1 number",
        ),
        (
            "material = \"red\"",
            "material = 1979-05-27",
            19,
            "material is a date or time, not a text",
        ),
        (
            "center = [0, 0, -3]",
            "center = 2020-01-01",
            17,
            "center is a date or time, not a list of three numbers",
        ),
        (
            "center = [0, 0, -3]",
            "center = [0, 07:32:00, -3]",
            17,
            "center holds a date or time, not three numbers",
        ),
        ("radius = 0.5", "radius = 1e-40", 18, "radius = 1e-40"),
        ("radius = 100", "radius = 1e18", 22, "beyond 1e18"),
        ("[0, 0.5, 1]", "[0, 1e16, 1]", 5, "above 1e15"),
        (
            "material = \"red\"",
            "material = \"blue\"",
            19,
            "no material \"blue\"",
        ),
        (
            "radius = 100",
            "radius = 100\n[particles]\nfile = \"no.pdb\"",
            25,
            "no such file",
        ),
        (
            "radius = 100",
            "radius = 100\n[particles]\nfile = \"no.gro\"",
            25,
            "not a particle format",
        ),
        (
            "radius = 100",
            "radius = 100\nradius = 1",
            24,
            "duplicate key",
        ),
    ];
    for (good, bad, line, word) in cases {
        assert!(GOOD.contains(good), "{good}");
        let error = read(&GOOD.replacen(good, bad, 1)).expect_err(bad);
        let Error::Scene(error) = error else {
            panic!("{bad}: {error:?}")
        };
        assert!(error.message.contains(word), "{bad}: {}", error.message);
        assert!(!error.help.is_empty(), "{bad}");
        let place = error.place.as_ref().expect("a place");
        assert_eq!(place.line_column().0, line, "{bad}: {error:?}");
    }
}

/// The parser does not say where a key of many parts is, so no place is shown for it.
#[test]
fn a_mistake_without_a_place_has_none() {
    let key = ["a"; 100].join(".");
    for text in [format!("{GOOD}\n{key} = 1\n"), format!("\n[{key}]\n")] {
        let error = read(&text).expect_err("a long key");
        let Error::Scene(error) = error else {
            panic!("{error:?}")
        };
        assert!(error.message.contains("more than 80 parts"), "{error}");
        assert!(error.place.is_none(), "{error}");
    }
}

/// Each error in a scene of its own: the scene's text besides a sphere, and a word of the message.
#[test]
#[expect(clippy::too_many_lines, reason = "one table, an entry a mistake")]
fn each_key_of_the_effects_refuses_what_it_cannot_be() {
    let cases = [
        ("camera = 5", "this is the whole number `5`, not a table"),
        ("camera = 2020-01-01", "this is a date or time, not a table"),
        ("[image]\nsamples = 0", "samples = 0"),
        ("[image]\nclamp = 0", "clamp = 0"),
        ("[image]\nfilter = \"sinc\"", "there is no filter \"sinc\""),
        ("[image]\nfilter_width = 0", "filter_width = 0"),
        ("[image]\nfilter_width = 65", "filter_width = 65"),
        (
            "[image]\nglass_shadows = \"grey\"",
            "there is no glass_shadows \"grey\"",
        ),
        ("[image]\nsamples = 65537", "65537"),
        ("[image]\nmax_bounces = -1", "max_bounces = -1"),
        ("[image]\nambient_occlusion = 0", "ambient_occlusion = 0"),
        ("[image]\nseed = -5", "seed = -5"),
        ("[image]\nexposure = 100", "exposure = 100"),
        ("[image]\nexposure = nan", "exposure = NaN"),
        (
            "[image]\ntonemap = \"film\"",
            "there is no tonemap \"film\"",
        ),
        (
            "[image]\ntransparent = 1",
            "transparent is 1, not true or false",
        ),
        ("[image]\ncaustics = 1", "caustics is 1, not true or false"),
        (
            "[image]\nsamples = \"4\"",
            "samples is the text \"4\", not a whole number",
        ),
        ("[sky]\nimage = 3", "image is 3, not a text"),
        ("[materials.m]\nkind = true", "kind is true, not a text"),
        (
            "[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\naperture = -1",
            "aperture = -1",
        ),
        (
            "[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nfocus_distance = 0",
            "focus_distance = 0",
        ),
        (
            "[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nshutter = [1, 0]",
            "not a pair of times",
        ),
        (
            "[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nshutter = [1]",
            "not a pair of times",
        ),
        ("[materials.m]\nkind = \"diffuse\"", "has no color"),
        (
            "[materials.m]\nkind = \"diffuse\"\ncolor = [1, 1, 1]\nroughness = 0.5",
            "has no roughness",
        ),
        (
            "[materials.m]\nkind = \"glass\"\ncolor = [1, 1, 1]",
            "has no color",
        ),
        ("[materials.m]\nkind = \"glass\"\nindex = 0", "index = 0"),
        (
            "[materials.m]\nkind = \"plastic\"\ncolor = [1, 1, 1]\nindex = 1",
            "index = 1 is not possible",
        ),
        (
            "[materials.m]\nkind = \"plastic\"\ncolor = [1, 1, 1]\nstrength = 1",
            "a material of kind plastic has no strength",
        ),
        (
            "[materials.m]\nkind = \"plastic\"\ncolor = [1, 2, 1]",
            "channel above one",
        ),
        (
            "[materials.m]\nkind = \"glass\"\nabsorption = [-1, 0, 0]",
            "below zero",
        ),
        (
            "[materials.m]\nkind = \"glass\"\nthickness = 0",
            "thickness = 0",
        ),
        (
            "[materials.m]\nkind = \"glass\"\nthickness = 2\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"m\"",
            "leaves no hollow",
        ),
        (
            "[materials.m]\nkind = \"glass\"\nthickness = 1e-9\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"m\"",
            "too thin",
        ),
        (
            "[materials.m]\nkind = \"emissive\"\ncolor = [1e9, 0, 0]\nstrength = 1e9",
            "too bright",
        ),
        (
            "[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nshutter = [0, 1e9]\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nvelocity = [0, 1e10, 0]",
            "moves",
        ),
        (
            "[materials.m]\nkind = \"metal\"\ncolor = [1, 1, 1]\nroughness = 1.5",
            "roughness = 1.5",
        ),
        (
            "[materials.m]\nkind = \"metal\"\ncolor = [2, 1, 1]",
            "above one",
        ),
        (
            "[materials.m]\nkind = \"emissive\"\ncolor = [1, 1, 1]\nstrength = -1",
            "strength = -1",
        ),
        (
            "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nvelocity = [1, 0]",
            "2 numbers",
        ),
        (
            "[[light]]\nposition = [0, 9, 0]",
            "missing field `intensity`",
        ),
        (
            "[[light]]\nposition = [0, 9, 0]\nintensity = [-1, 0, 0]",
            "below zero",
        ),
        (
            "[[light]]\nposition = [0, 9, 0]\nintensity = [1, 1, 1]\nradius = -1",
            "radius = -1",
        ),
        (
            "[[light]]\nposition = [0, 9, 0]\nintensity = [1e18, 1, 1]\nradius = 1e-15",
            "too bright",
        ),
        ("[sky]\nhorizon = [-1, 0, 0]", "below zero"),
        ("[sky]\nsun_direction = [0, 0, 0]", "sun_direction is zero"),
        ("[sky]\nsun_irradiance = [1, 1, 1]", "no direction"),
        (
            "[sky]\nsun_direction = [0, 1, 0]\nsun_size = 181",
            "sun_size = 181",
        ),
        (
            "[sky]\nsun_direction = [0, 1, 0]\nsun_size = 1e-9",
            "too bright for its size",
        ),
        (
            "[sky]\nzenith = [1e10, 0, 0]\nstrength = 1e10",
            "zenith times a strength",
        ),
        ("[sky]\nimage = \"no.hdr\"", "cannot be opened"),
        ("[sky]\nstrength = -1", "strength = -1"),
        ("[fog]\nalbedo = [1, 1, 1]", "missing field `extinction`"),
        ("[fog]\nextinction = 0", "extinction = 0"),
        (
            "[fog]\nextinction = 1\nalbedo = [2, 0, 0]",
            "albedo has a channel above one",
        ),
        ("[fog]\nextinction = 1\nanisotropy = 1", "anisotropy = 1"),
        ("[fog]\nextinction = 1\nradius = 0", "radius = 0"),
        ("[fog]\nextinction = 1\ncenter = [0, 0, 0]", "no radius"),
    ];
    for (text, word) in cases {
        let text = format!("{text}\n[[sphere]]\ncenter = [0, 0, -3]\nradius = 0.5\n");
        let Err(Error::Scene(error)) = read(&text) else {
            panic!("{text} is read")
        };
        assert!(error.message.contains(word), "{text}: {}", error.message);
        assert!(!error.help.is_empty() && error.place.is_some(), "{text}");
    }
}

/// The reader, the schema and the documentation of keys have the same keys.
#[test]
#[expect(
    clippy::too_many_lines,
    reason = "one table, an entry a table of the file"
)]
fn the_schema_and_the_docs_list_every_key() {
    let schema: serde_json::Value =
        serde_json::from_str(include_str!("../../../scenes/scene.schema.json")).expect("JSON");
    let page = include_str!("../../../docs/scenes.md");
    let root = &schema["properties"];
    let tables = [
        ("", &schema["properties"], "[zzz]\n"),
        (
            "[image]",
            &root["image"]["properties"],
            "[image]\nzzz = 1\n",
        ),
        (
            "[camera]",
            &root["camera"]["properties"],
            "[camera]\nzzz = 1\n",
        ),
        (
            "[materials.NAME]",
            &root["materials"]["additionalProperties"]["properties"],
            "[materials.m]\nzzz = 1\n",
        ),
        (
            "[[sphere]]",
            &root["sphere"]["items"]["properties"],
            "[[sphere]]\nzzz = 1\n",
        ),
        (
            "[[capsule]]",
            &root["capsule"]["items"]["properties"],
            "[[capsule]]\nzzz = 1\n",
        ),
        (
            "[[cylinder]]",
            &root["cylinder"]["items"]["properties"],
            "[[cylinder]]\nzzz = 1\n",
        ),
        (
            "[[cone]]",
            &root["cone"]["items"]["properties"],
            "[[cone]]\nzzz = 1\n",
        ),
        (
            "[[ellipsoid]]",
            &root["ellipsoid"]["items"]["properties"],
            "[[ellipsoid]]\nzzz = 1\n",
        ),
        (
            "[[box]]",
            &root["box"]["items"]["properties"],
            "[[box]]\nzzz = 1\n",
        ),
        (
            "[[disc]]",
            &root["disc"]["items"]["properties"],
            "[[disc]]\nzzz = 1\n",
        ),
        (
            "[[light]]",
            &root["light"]["items"]["properties"],
            "[[light]]\nzzz = 1\n",
        ),
        ("[sky]", &root["sky"]["properties"], "[sky]\nzzz = 1\n"),
        ("[fog]", &root["fog"]["properties"], "[fog]\nzzz = 1\n"),
        (
            "[particles]",
            &root["particles"]["properties"],
            "[particles]\nzzz = 1\n",
        ),
    ];
    for (name, properties, wrong) in tables {
        let Err(Error::Scene(error)) = read(wrong) else {
            panic!("{wrong} is read")
        };
        // serde lists the fields that it expected.
        let expected = error.message.split_once("expected").expect("names").1;
        let mut reader: Vec<&str> = expected.split('`').skip(1).step_by(2).collect();
        let mut known: Vec<&str> = properties
            .as_object()
            .expect("keys")
            .keys()
            .map(String::as_str)
            .collect();
        reader.sort_unstable();
        known.sort_unstable();
        assert_eq!(reader, known, "{name}");
        if !name.is_empty() {
            let section = page
                .split("\n## ")
                .find(|part| part.starts_with(&format!("`{name}`")));
            let section = section.unwrap_or_else(|| panic!("docs/scenes.md has no {name}"));
            for key in known {
                assert!(section.contains(&format!("| `{key}` |")), "{name} {key}");
            }
        }
    }
}

#[test]
fn a_scene_without_spheres_is_refused() {
    let error = read("[image]\nwidth = 3").expect_err("no spheres");
    assert!(error.to_string().contains("no spheres"));
}

/// `[[sphere]]` tables between others, in every spelling.
#[test]
fn a_file_is_split_at_its_headers() {
    let scene =
        read("\u{feff}[[sphere]] # [[sphere]]\r\ncenter = [ # a [ comment\r\n  1,\r\n[].x, ]\r\n");
    assert!(scene.is_err());
    let scene = read(concat!(
        "\u{feff}[[sphere]] # [[sphere]]\r\ncenter = [ # a [ comment\r\n  1, 0,\r\n0 ]\r\nradius = 1\r\n",
        "  [[ 'sphere' ]]\r\ncenter = [2, 0, 0]\r\nradius = 1\r\nmaterial = \"a [[sphere]]\"\r\n",
        "[materials.\"a [[sphere]]\"]\r\nkind = \"glass\"\r\n",
        "[[\"sphere\"]]\r\ncenter = [3, 0, 0]\r\nradius = 1\r\nmaterial = \"\"\"\r\nb\\n[[sphere]]\"\"\"\r\n",
        "[image]\r\nwidth = 3\r\n",
        "[materials.\"b\\n[[sphere]]\"]\r\nkind = \"glass\"\r\n",
        "[[sphere]]\r\ncenter = [4, 0, 0]\r\nradius = 1",
    ))
    .expect("a scene");
    let places: Vec<f32> = scene.world.spheres.iter().map(|s| s.center().x).collect();
    assert_eq!(places, [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(scene.world.material_ids, [2, 0, 1, 2]);
    assert_eq!(scene.width, 3);
    let list = "sphere = [{ center = [0, 0, 0], radius = 1 }]\n";
    assert_eq!(read(list).expect("a scene").world.spheres.len(), 1);
}

/// An error among very many spheres is found, and an open bracket does not swallow all of them.
#[test]
fn among_many_spheres_a_mistake_is_found() {
    let sphere = |index: usize| format!("[[sphere]]\ncenter = [{index}, 0, 0]\nradius = 1\n");
    let count = 10_000;
    let many: Vec<String> = (0..count).map(sphere).collect();
    let spheres = read(&many.concat()).expect("a scene").world.spheres;
    assert!((0..count).all(|index| spheres[index].center().x == index as f32));
    assert_eq!(spheres.len(), count);
    for (wrong, line, word) in [
        ("radius = -1", 3, "radius = -1"),
        ("radius = 1\nradius = 2", 4, "duplicate key"),
        ("raduis = 1", 3, "unknown field"),
        ("radius = [1", 4, ""),
        ("radius = \"\"\"1", 1, "more than 65536 bytes"),
        ("radius = 1 2", 3, ""),
        (
            "radius = 1\n[sphere.more]\na = 1",
            4,
            "this is a table, not a list",
        ),
        ("radius = 1\n[image]\nsphere = 1", 5, "unknown field"),
    ] {
        let mut many = many.clone();
        many[7000] = many[7000].replace("radius = 1", wrong);
        let Err(Error::Scene(error)) = read(&many.concat()) else {
            panic!("{wrong} is read")
        };
        assert!(error.message.contains(word), "{wrong}: {}", error.message);
        let (found, _) = error.place.as_ref().expect("a place").line_column();
        let expected = 3 * 7000 + line;
        // An open bracket is noticed in the next line.
        assert!(
            (expected..=expected + 1).contains(&found),
            "{wrong}: {found}"
        );
    }
    let both = format!(
        "sphere = [{{ center = [0, 0, 0], radius = 1 }}]\n{}",
        many[0]
    );
    let error = read(&both).expect_err("two kinds").to_string();
    assert!(
        error.starts_with("test.toml:2:1: there is already a list of spheres"),
        "{error}"
    );
    let long = format!("{}x = \"{}\"\n", many[0], "y".repeat(MAX_TEXT));
    let error = read(&format!(
        "[image]\n{}\n{long}",
        "# c\n".repeat(MAX_TEXT / 4)
    ));
    assert!(
        error
            .expect_err("too long")
            .to_string()
            .contains("has more than")
    );
    assert!(
        read(&long)
            .expect_err("too long")
            .to_string()
            .contains("more than 65536 bytes")
    );
}

/// Names from files are escaped before they go to a terminal.
#[test]
fn messages_hold_no_escapes_and_no_megabytes() {
    let long = "n".repeat(5_000_000);
    let sphere = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n";
    for text in [
        format!("{sphere}material = \"\\u001b[31m\u{202e}\""),
        format!("{sphere}material = \"{long}\""),
        format!("{sphere}material = \"a\"\n[materials.\"\\u001b{long}\"]\nkind = \"glass\""),
        format!("\"\\u001b{long}\" = 1"),
        format!("[image]\n\"\\u001b{long}\" = 1"),
        format!("[image]\ntonemap = \"\\u001b{long}\""),
        format!("[image]\nwidth = \"\\u001b{long}\""),
        format!("{sphere}[sky]\nimage = \"\\u001b{long}\""),
        format!("{sphere}[particles]\nfile = \"\\u001b{long}.pdb\""),
        format!("{sphere}[particles]\nfile = \"\\u001b{long}\""),
    ] {
        let error = read(&text).expect_err("a refusal");
        let said = format!("{error}{}", error.help());
        let start = &text[..text.len().min(90)];
        assert!(said.len() < 1500, "{start}: {} bytes", said.len());
        assert!(!said.contains(['\u{1b}', '\u{202e}']), "{start}: {said:?}");
    }
}
