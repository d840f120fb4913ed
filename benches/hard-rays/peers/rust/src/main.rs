//! Answers hard rays with crates: parry3d and parry3d-f64 0.31.1, bvh 0.13.0.
//!
//! ```sh
//! cargo run --release -- hard-rays.txt parry3d > ANSWERS.txt # or parry3d-f64, or bvh
//! ```
//!
//! - parry3d: `RayCast::cast_ray` of a `Ball` moved to its centre, not solid, so that rays that
//!   start inside hit it from there.
//! - parry3d-f64: the same in 64-bit floats, which hold every number of a ray.
//! - bvh: it has no sphere, only the test of a box, which must not miss where the sphere is hit.
//!   The sphere's box is as in bvh's README; the answers are `hit` or `miss` of that box, so that
//!   only the missed hits mean anything.
//!
//! Rays of theirs begin at zero; those with another `t_min` are not asked.

use std::process::ExitCode;

/// A ray and its sphere.
struct Ray {
    origin: [f32; 3],
    direction: [f32; 3],
    t_min: f32,
    t_max: f32,
    center: [f32; 3],
    radius: f32,
}

enum Answer {
    Miss,
    /// A hit without its t.
    Hit,
    T(f64),
}

fn parry3d(ray: &Ray) -> Answer {
    use parry3d::{math, query, query::RayCast, shape};
    let cast = query::Ray::new(
        math::Vector::from_array(ray.origin),
        math::Vector::from_array(ray.direction),
    );
    let at = math::Pose::from_translation(math::Vector::from_array(ray.center));
    let t = shape::Ball::new(ray.radius).cast_ray(&at, &cast, ray.t_max, false);
    before_the_end(ray, t.map(f64::from))
}

fn parry3d_f64(ray: &Ray) -> Answer {
    use parry3d_f64::{math, query, query::RayCast, shape};
    let wide = |v: [f32; 3]| math::Vector::from_array(v.map(f64::from));
    let cast = query::Ray::new(wide(ray.origin), wide(ray.direction));
    let at = math::Pose::from_translation(wide(ray.center));
    let ball = shape::Ball::new(ray.radius.into());
    before_the_end(ray, ball.cast_ray(&at, &cast, ray.t_max.into(), false))
}

/// Intervals of hard rays do not hold their end.
fn before_the_end(ray: &Ray, t: Option<f64>) -> Answer {
    match t {
        Some(t) if t < ray.t_max.into() => Answer::T(t),
        _ => Answer::Miss,
    }
}

fn bvh(ray: &Ray) -> Answer {
    use nalgebra::{Point3, Vector3};
    let center = Point3::from(ray.center);
    let half = Vector3::repeat(ray.radius);
    let aabb = bvh::aabb::Aabb::with_bounds(center - half, center + half);
    let ray = bvh::ray::Ray::new(Point3::from(ray.origin), Vector3::from(ray.direction));
    if ray.intersects_aabb(&aabb) {
        Answer::Hit
    } else {
        Answer::Miss
    }
}

/// A number in the hexadecimal form of C99: `0x1.8p+1` is 3.
fn number(text: &str) -> Option<f32> {
    let (sign, digits) = match text.strip_prefix('-') {
        Some(digits) => (-1.0, digits),
        None => (1.0, text),
    };
    let (digits, exponent) = digits.strip_prefix("0x")?.split_once('p')?;
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let digits = u64::from_str_radix(&format!("{whole}{fraction}"), 16).ok()?;
    let exponent = exponent.parse::<i32>().ok()? - 4 * fraction.len() as i32;
    // Powers of two beyond 2^±1022 are not among the numbers of rays.
    let exact = sign * digits as f64 * 2.0_f64.powi(exponent);
    let number = exact as f32;
    (f64::from(number) == exact).then_some(number)
}

fn ray(line: &str) -> Option<Ray> {
    // The first is the number of the set; the answer follows.
    let numbers = line.split_whitespace().skip(1).take(12).map(number);
    let x: [f32; 12] = numbers.collect::<Option<Vec<_>>>()?.try_into().ok()?;
    Some(Ray {
        origin: [x[0], x[1], x[2]],
        direction: [x[3], x[4], x[5]],
        t_min: x[6],
        t_max: x[7],
        center: [x[8], x[9], x[10]],
        radius: x[11],
    })
}

fn answers(file: &str, ask: fn(&Ray) -> Answer) -> Result<String, String> {
    let text = std::fs::read_to_string(file).map_err(|error| format!("{file}: {error}"))?;
    if !text.starts_with("# hard-rays 1,") {
        return Err(format!("{file}: not hard rays of version 1"));
    }
    let mut answers = String::new();
    for (index, line) in text.lines().enumerate() {
        if line.starts_with('#') {
            continue;
        }
        let ray = ray(line).ok_or_else(|| {
            let number = index + 1;
            format!("{file}:{number}: not the twelve numbers of a ray")
        })?;
        answers += &if ray.t_min == 0.0 {
            match ask(&ray) {
                Answer::Miss => "miss\n".into(),
                Answer::Hit => "hit\n".into(),
                Answer::T(t) => format!("{t:e}\n"),
            }
        } else {
            "-\n".into()
        };
    }
    Ok(answers)
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (file, ask): (_, fn(&Ray) -> Answer) = match arguments[..] {
        [file, "parry3d"] => (file, parry3d),
        [file, "parry3d-f64"] => (file, parry3d_f64),
        [file, "bvh"] => (file, bvh),
        _ => {
            eprintln!("usage: hard-rays-crates hard-rays.txt parry3d|parry3d-f64|bvh");
            return ExitCode::from(2);
        }
    };
    match answers(file, ask) {
        Ok(answers) => {
            print!("{answers}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}
