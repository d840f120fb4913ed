//! The README's scene, its error message and its links are right.

use std::path::Path;

use spherule::read::toml::parse;

const README: &str = include_str!("../README.md");

/// The content of the README's first block of this language.
fn block(language: &str) -> &'static str {
    let start = README
        .find(&format!("```{language}\n"))
        .expect("a block of this language");
    let body = &README[start + language.len() + 4..];
    &body[..body.find("```").expect("the block's end")]
}

#[test]
fn the_scene_is_read() {
    let scene = parse(Path::new("scenes/readme.toml"), block("toml").into()).expect("a scene");
    assert_eq!(scene.world.spheres.len(), 1 + 327);
    assert_eq!(scene.view.expect("a camera").vertical_fov, 40.0);
    assert_eq!((scene.width, scene.height), (1280, 720));
}

#[test]
fn the_mistake_is_found_where_the_readme_says() {
    let shown = block("text");
    let text = "\n".repeat(16) + "center = [0, 0, -3]\nradius = -1\n";
    let text = text.replacen('\n', "[[sphere]]\n", 1);
    let error = parse(Path::new("scene.toml"), text).expect_err("a mistake");
    assert!(shown.contains(&error.to_string()), "{error}");
    assert!(shown.contains(&error.help()), "{}", error.help());
}

#[test]
fn every_linked_page_exists() {
    let links = README
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next())
        .filter(|link| !link.contains("://"));
    let mut count = 0;
    for link in links {
        assert!(Path::new(link).exists(), "{link}");
        count += 1;
    }
    assert!(count > 5);
}
