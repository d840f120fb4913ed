//! ꟻLIP: the difference between two images as somebody sees it who flips between them.
//!
//! P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström and M. D. Fairchild,
//! ꟻLIP: a difference evaluator for alternating images, Proc. ACM Comput. Graph. Interact. Tech. 3
//! (2020). Colours are filtered by the contrast sensitivity of the eye at a viewing distance,
//! their difference is that of `HyAB` in Hunt-adjusted CIELAB, and edges and points that only one
//! image has raise it. A test holds the result against the authors' own program.

use rayon::prelude::*;

use super::Image;
use super::encode::{Encoder, from_srgb};

/// Pixels in a degree of the visual field: a 0.7 m wide 3840-pixel screen seen from 0.7 m, the
/// authors' own choice.
pub const PIXELS_PER_DEGREE: f64 = 67.020_643_276_582_26;

/// The mean ꟻLIP of two images as they would be shown on a screen: 0 where nobody sees a
/// difference, 1 at most. `None` if they differ in size or in shading, or have no pixels.
#[must_use]
pub fn mean_flip(reference: &Image, test: &Image) -> Option<f64> {
    if (reference.width, reference.height, reference.shading)
        != (test.width, test.height, test.shading)
        || reference.pixels.is_empty()
    {
        return None;
    }
    let encoder = Encoder::of_both(reference, test);
    let linear = |image: &Image| -> Vec<[f32; 3]> {
        image
            .pixels
            .par_iter()
            .map(|pixel| encoder.encode(pixel).map(from_srgb))
            .collect()
    };
    let width = reference.width as usize;
    let errors = errors(&linear(reference), &linear(test), width, PIXELS_PER_DEGREE);
    let sum: f64 = errors.par_iter().map(|error| f64::from(*error)).sum();
    Some(sum / errors.len().max(1) as f64)
}

/// The error of each pixel, for linear colours in rows of `width`.
fn errors(
    reference: &[[f32; 3]],
    test: &[[f32; 3]],
    width: usize,
    pixels_per_degree: f64,
) -> Vec<f32> {
    let (a, b) = (
        Seen::of(reference, width, pixels_per_degree),
        Seen::of(test, width, pixels_per_degree),
    );
    // The largest difference of colours there is: pure green against pure blue.
    let largest = difference(hunt([0.0, 1.0, 0.0]), hunt([0.0, 0.0, 1.0])).powf(0.7);
    (0..reference.len())
        .into_par_iter()
        .map(|index| {
            let color = difference(a.color[index], b.color[index]).powf(0.7);
            let knee = 0.4 * largest;
            let color = if color < knee {
                color * 0.95 / knee
            } else {
                0.95 + (color - knee) / (largest - knee) * 0.05
            };
            let edge = (a.edge[index] - b.edge[index]).abs();
            let point = (a.point[index] - b.point[index]).abs();
            let feature = (edge.max(point) * std::f32::consts::FRAC_1_SQRT_2).sqrt();
            color.powf(1.0 - feature.min(1.0))
        })
        .collect()
}

/// An image as the eye takes it in.
struct Seen {
    /// Filtered, in Hunt-adjusted CIELAB.
    color: Vec<[f32; 3]>,
    /// How strong an edge there is in each pixel.
    edge: Vec<f32>,
    /// How strong a point or a thin line.
    point: Vec<f32>,
}

impl Seen {
    fn of(linear: &[[f32; 3]], width: usize, pixels_per_degree: f64) -> Self {
        let opponent: Vec<[f32; 3]> = linear.par_iter().map(|c| to_opponent(*c)).collect();
        let plane = |channel: usize| -> Vec<f32> {
            opponent.par_iter().map(|pixel| pixel[channel]).collect()
        };
        let radius = (3.0 * (0.04 / (2.0 * PI_SQUARED)).sqrt() * pixels_per_degree).ceil() as i32;
        let contrast = |b: f64| {
            kernel(radius, |x| {
                (-PI_SQUARED * (x / pixels_per_degree).powi(2) / b).exp()
            })
        };
        let blurred = |channel: usize, terms: &[(f64, f64)]| -> Vec<f32> {
            let plane = plane(channel);
            let mut result = vec![0.0; plane.len()];
            let mut total = 0.0;
            for (a, b) in terms {
                let kernel = contrast(*b);
                let weight = a * (std::f64::consts::PI / b).sqrt();
                total += weight * kernel.iter().sum::<f64>().powi(2);
                let filtered = filter(&plane, width, &kernel, &kernel);
                for (sum, value) in result.iter_mut().zip(filtered) {
                    *sum += weight as f32 * value;
                }
            }
            result.iter_mut().for_each(|value| *value /= total as f32);
            result
        };
        let luminance = blurred(0, &[(1.0, 0.0047)]);
        let red_green = blurred(1, &[(1.0, 0.0053)]);
        let blue_yellow = blurred(2, &[(34.1, 0.04), (13.5, 0.025)]);
        let color = (0..linear.len())
            .into_par_iter()
            .map(|i| {
                let clamped = from_opponent([luminance[i], red_green[i], blue_yellow[i]])
                    .map(|x| x.clamp(0.0, 1.0));
                hunt(clamped)
            })
            .collect();

        let grey: Vec<f32> = opponent.par_iter().map(|p| (p[0] + 16.0) / 116.0).collect();
        let sigma = 0.5 * 0.082 * pixels_per_degree;
        let radius = (3.0 * sigma).ceil() as i32;
        let bell = kernel(radius, |x| (-x * x / (2.0 * sigma * sigma)).exp());
        let slope = kernel(radius, |x| -x * (-x * x / (2.0 * sigma * sigma)).exp());
        let bump = kernel(radius, |x| {
            (x * x / (sigma * sigma) - 1.0) * (-x * x / (2.0 * sigma * sigma)).exp()
        });
        let strength = |shape: &[f64]| -> Vec<f32> {
            let shape = balanced(shape, bell.iter().sum());
            let along_x = filter(&grey, width, &shape, &bell);
            let along_y = filter(&grey, width, &bell, &shape);
            along_x
                .iter()
                .zip(along_y)
                .map(|(x, y)| x.hypot(y))
                .collect()
        };
        Self {
            color,
            edge: strength(&slope),
            point: strength(&bump),
        }
    }
}

const PI_SQUARED: f64 = std::f64::consts::PI * std::f64::consts::PI;

fn kernel(radius: i32, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    (-radius..=radius).map(|x| weight(f64::from(x))).collect()
}

/// Scaled so that, together with a bell across of this sum, what is positive makes 1 and what is
/// negative −1.
fn balanced(shape: &[f64], across: f64) -> Vec<f64> {
    let positive: f64 = shape.iter().filter(|w| **w > 0.0).sum();
    let negative: f64 = -shape.iter().filter(|w| **w < 0.0).sum::<f64>();
    shape
        .iter()
        .map(|w| w / (across * if *w > 0.0 { positive } else { negative }))
        .collect()
}

/// The plane filtered along its rows and then along its columns; beyond its edges it goes on as
/// it ends.
fn filter(plane: &[f32], width: usize, along_x: &[f64], along_y: &[f64]) -> Vec<f32> {
    let height = plane.len() / width;
    let pass = |source: &[f32], kernel: &[f64], horizontal: bool| -> Vec<f32> {
        let radius = (kernel.len() / 2) as isize;
        let mut result = vec![0.0; source.len()];
        result
            .par_chunks_mut(width)
            .enumerate()
            .for_each(|(y, row)| {
                for (x, value) in row.iter_mut().enumerate() {
                    let sum: f64 = kernel
                        .iter()
                        .zip(-radius..)
                        .map(|(weight, offset)| {
                            let moved = |at: usize, end: usize| {
                                (at as isize + offset).clamp(0, end as isize - 1) as usize
                            };
                            let at = if horizontal {
                                y * width + moved(x, width)
                            } else {
                                moved(y, height) * width + x
                            };
                            weight * f64::from(source[at])
                        })
                        .sum();
                    *value = sum as f32;
                }
            });
        result
    };
    pass(&pass(plane, along_x, true), along_y, false)
}

/// Linear Rec. 709 to CIE XYZ, as fractions of the white point D65.
fn to_xyz([r, g, b]: [f32; 3]) -> [f32; 3] {
    let rows = RGB_TO_XYZ.map(|row| row[0] * r + row[1] * g + row[2] * b);
    let white = RGB_TO_XYZ.map(|row| row[0] + row[1] + row[2]);
    [0, 1, 2].map(|i| rows[i] / white[i])
}

/// IEC 61966-2-1.
const RGB_TO_XYZ: [[f32; 3]; 3] = [
    [0.412_396, 0.357_585, 0.180_481],
    [0.212_639, 0.715_169, 0.072_192],
    [0.019_331, 0.119_195, 0.950_532],
];

/// Its inverse.
const XYZ_TO_RGB: [[f32; 3]; 3] = [
    [3.240_97, -1.537_384, -0.498_611],
    [-0.969_243, 1.875_968, 0.041_555],
    [0.055_63, -0.203_977, 1.056_972],
];

/// The opponent space `YCxCz`.
fn to_opponent(linear: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = to_xyz(linear);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn from_opponent([luminance, red_green, blue_yellow]: [f32; 3]) -> [f32; 3] {
    let y = (luminance + 16.0) / 116.0;
    let relative = [y + red_green / 500.0, y, y - blue_yellow / 200.0];
    let white = RGB_TO_XYZ.map(|row| row[0] + row[1] + row[2]);
    let xyz = [0, 1, 2].map(|i| relative[i] * white[i]);
    XYZ_TO_RGB.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

/// CIELAB with the chroma scaled by the lightness (the Hunt effect).
fn hunt(linear: [f32; 3]) -> [f32; 3] {
    let curve = |t: f32| {
        let delta: f32 = 6.0 / 29.0;
        if t > delta.powi(3) {
            t.cbrt()
        } else {
            t / (3.0 * delta * delta) + 4.0 / 29.0
        }
    };
    let [x, y, z] = to_xyz(linear).map(curve);
    let lightness = 116.0 * y - 16.0;
    [
        lightness,
        0.01 * lightness * 500.0 * (x - y),
        0.01 * lightness * 200.0 * (y - z),
    ]
}

/// `HyAB`: city block in lightness, Euclid in chroma.
fn difference(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use glam::Vec3;
    use spherule_kernel::{Pixel, Shading};

    fn image(color: impl Fn(u32, u32) -> Vec3) -> Image {
        let (width, height) = (61, 47);
        let pixels = (0..width * height)
            .map(|i| {
                // Colours that 8 bits hold exactly, as the authors' program takes them.
                let eight_bits =
                    |x: f32| from_srgb((super::super::encode::srgb(x) * 255.0).round() / 255.0);
                let color = color(i % width, i / width).to_array().map(eight_bits);
                Pixel::new(Vec3::from_array(color), 1.0)
            })
            .collect();
        Image::new(width, height, Shading::Lit, pixels).expect("an image")
    }

    /// Within what 32-bit sums leave.
    #[test]
    fn it_agrees_with_the_authors_program() {
        let mut random = Random::new(17);
        let noise: Vec<Vec3> = (0..61 * 47).map(|_| random.vec3(0.0, 1.0)).collect();
        let noise = |x: u32, y: u32| noise[(y * 61 + x) as usize];
        let disc = |x: u32, y: u32, r: f32| {
            let off = Vec3::new(x as f32 - 30.0, y as f32 - 20.0, 0.0).length();
            if off < r {
                Vec3::new(0.8, 0.3, 0.1)
            } else {
                Vec3::new(0.1, 0.2, 0.6)
            }
        };
        let pairs = [
            (
                image(|x, y| disc(x, y, 12.0)),
                image(|x, y| disc(x, y, 13.0)),
            ),
            (image(|x, y| disc(x, y, 12.0)), image(noise)),
            (
                image(|x, y| disc(x, y, 9.0)),
                image(|x, y| disc(x, y, 9.0) * 0.9 + noise(x, y) * 0.05),
            ),
            (image(|_, _| Vec3::Y), image(|_, _| Vec3::Z)),
        ];
        for (a, b) in &pairs {
            let theirs = {
                let rgb = |image: &Image| {
                    nv_flip::FlipImageRgb8::with_data(
                        image.width(),
                        image.height(),
                        &image.to_rgb8(),
                    )
                };
                let errors = nv_flip::flip(rgb(a), rgb(b), nv_flip::DEFAULT_PIXELS_PER_DEGREE);
                f64::from(nv_flip::FlipPool::from_image(&errors).mean())
            };
            let ours = mean_flip(a, b).expect("comparable");
            assert!((ours - theirs).abs() < 1e-4, "{ours} {theirs}");
        }
        assert_eq!(mean_flip(&pairs[0].0, &pairs[0].0), Some(0.0));
    }

    #[test]
    fn other_sizes_do_not_compare() {
        let a = image(|_, _| Vec3::ZERO);
        let b = Image::new(1, 1, Shading::Lit, vec![Pixel::default()]).expect("an image");
        assert_eq!(mean_flip(&a, &b), None);
    }
}
