//! The report: accuracy against time as one self-contained HTML page, with its plots as SVG, for
//! the screen and for print.

use std::fmt::Write;

use super::frames::Frame;
use super::measure::RungErrors;
use super::price::Price;
use super::samples::Step;
use crate::ulp;

/// The results of one rung on one family.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    /// The rung's name.
    pub rung: &'a str,
    /// The time of an intersection.
    pub price: Price,
    /// The rung's errors.
    pub measured: &'a RungErrors,
}

/// The results of one family.
#[derive(Clone, Debug)]
pub struct FamilyResults<'a> {
    /// The family's name.
    pub name: &'a str,
    /// A sentence below the plot.
    pub note: String,
    /// The results of each rung.
    pub rungs: Vec<Row<'a>>,
}

/// Colours that remain distinct for colour-blind readers and in grey (Okabe and Ito, 2008).
const COLORS: [&str; 5] = ["#d55e00", "#0072b2", "#cc79a7", "#009e73", "#000000"];

const STYLE: &str = "\
body{font:15px/1.5 system-ui,sans-serif;color:#222;max-width:1080px;margin:2rem auto;padding:0 1rem}\
h1{font-size:1.6rem;margin-bottom:.2rem}h2{font-size:1.15rem;margin:2rem 0 .3rem}\
p{margin:.4rem 0;max-width:75ch}.plots{display:flex;flex-wrap:wrap;gap:1rem}figure{margin:0}\
figcaption{font-size:.85rem;color:#555}svg{background:#fff}svg text{font:12px system-ui,sans-serif;fill:#333}\
table{border-collapse:collapse;font-size:.85rem;margin:.6rem 0}th,td{padding:.15rem .5rem;text-align:right;white-space:nowrap}\
th{border-bottom:1px solid #999;font-weight:600}td:first-child,th:first-child{text-align:left}\
code{font-size:.8em}pre{font-size:.75rem;overflow-x:auto;background:#f6f6f6;padding:.7rem}\
@media print{body{margin:0;max-width:none}section{break-inside:avoid}}";

/// The page as HTML. `frames` are those of the scene with this name, `steps` those of its samples.
/// `table` is everything as text, for copying.
#[must_use]
pub fn page(
    device: &str,
    rays: u32,
    families: &[FamilyResults<'_>],
    frames: Option<(&str, &[Frame])>,
    steps: &[Step],
    table: &str,
) -> String {
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width\">\
         <title>What accuracy costs in time</title><style>{STYLE}</style></head><body>\n\
         <h1>What accuracy costs in time</h1>\n\
         <p>{}{}</p>\n",
        escape(device),
        if families.is_empty() {
            ".".to_owned()
        } else {
            format!(
                ", {rays} rays a family, every answer judged by exact arithmetic. Left: the largest error of the \
                 distance t against the time of one ray-sphere test; lower and further left is better, a bar goes from \
                 the fastest round to the slowest, and the dashed line joins the rungs that no other beats in both. A number beside a name \
                 counts the rays that were put on the wrong side of a silhouette. Right: the distribution of the errors of the hits."
            )
        },
    );
    for family in families {
        // Writing to a String cannot fail.
        let _ = writeln!(
            html,
            "<section><h2>{}</h2><div class=\"plots\"><figure>{}<figcaption>largest error against time</figcaption></figure>\
             <figure>{}<figcaption>share of the hits by error</figcaption></figure></div>{}<p>{}</p></section>",
            escape(family.name),
            scatter(&family.rungs),
            histograms(&family.rungs),
            worst_inputs(&family.rungs),
            escape(&family.note),
        );
    }
    if let Some((scene, frames)) = frames {
        let _ = writeln!(
            html,
            "<section><h2>Frames of {}</h2><div class=\"plots\"><figure>{}<figcaption>ꟻLIP against the reference, and \
             time</figcaption></figure><figure>{}<figcaption>pixels that differ from the reference, and \
             time</figcaption></figure></div><p>The reference is the CPU's image on <code>certified</code>.</p></section>",
            escape(scene),
            frame_plot(frames, "mean ꟻLIP", |frame| frame.flip),
            frame_plot(frames, "share of the pixels", |frame| {
                frame.differing as f64 / frame.pixels.max(1) as f64
            }),
        );
    }
    if !steps.is_empty() {
        let _ = writeln!(
            html,
            "<section><h2>Samples</h2><figure>{}<figcaption>error against time as samples double, from 1 to {}</figcaption>\
             </figure></section>",
            step_plot(steps),
            steps.iter().map(|step| step.samples).max().unwrap_or(1),
        );
    }
    let _ = write!(
        html,
        "<h2>The numbers</h2><pre>{}</pre>\n</body></html>\n",
        escape(table)
    );
    html
}

const WIDTH: f64 = 500.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 96.0;
const TOP: f64 = 14.0;
const BOTTOM: f64 = 44.0;

/// The vertical position, in the plot, of a height from 0 to 1.
fn y_of(height: f64) -> f64 {
    HEIGHT - BOTTOM - height * (HEIGHT - TOP - BOTTOM)
}

/// A point of a plot against time.
struct Point {
    label: String,
    /// Median, fastest and slowest time.
    time: f64,
    fastest: f64,
    slowest: f64,
    /// From 0, the bottom of the plot, to 1.
    height: f64,
}

/// The largest error of t against the time of a test.
fn scatter(rungs: &[Row<'_>]) -> String {
    // log₂(1 + ulp), from 0 to 32.
    let height = |ulp: f64| (1.0 + ulp).log2() / 32.0;
    let points: Vec<Point> = rungs
        .iter()
        .map(|row| {
            let wrong = row
                .measured
                .false_hits
                .saturating_add(row.measured.false_misses);
            Point {
                label: if wrong > 0 {
                    format!("{} ({wrong})", row.rung)
                } else {
                    row.rung.to_owned()
                },
                time: row.price.nanoseconds,
                fastest: row.price.fastest,
                slowest: row.price.slowest,
                height: height(f64::from(row.measured.max_ulp_anywhere.unwrap_or(0))),
            }
        })
        .collect();
    let ticks = [
        ("0", 0.0),
        ("1", 1.0),
        ("2⁸", 255.0),
        ("2¹⁶", 65_535.0),
        ("2²⁴", 16_777_215.0),
        ("2³²", 4_294_967_295.0),
    ]
    .map(|(label, ulp)| (label, height(ulp)));
    against_time(
        &points,
        "nanoseconds a test",
        "largest error of t, ulp",
        &ticks,
    )
}

/// A value of a frame, from 10⁻⁶ to 1, against its time.
fn frame_plot(frames: &[Frame], what: &str, value: impl Fn(&Frame) -> f64) -> String {
    // Zero has a place of its own, below 10⁻⁶.
    let height = |value: f64| {
        if value > 0.0 {
            ((value.log10() + 7.0) / 7.0).clamp(0.0, 1.0)
        } else {
            0.0
        }
    };
    let points: Vec<Point> = frames
        .iter()
        .map(|frame| Point {
            label: frame.rung.to_owned(),
            time: frame.milliseconds,
            fastest: frame.fastest,
            slowest: frame.slowest,
            height: height(value(frame)),
        })
        .collect();
    let ticks = [
        ("0", 0.0),
        ("10⁻⁶", 1e-6),
        ("10⁻⁴", 1e-4),
        ("0.01", 1e-2),
        ("1", 1.0),
    ]
    .map(|(label, at)| (label, height(at)));
    against_time(&points, "milliseconds a frame", what, &ticks)
}

/// The errors of images with more and more samples against their time, a line for each rung.
fn step_plot(steps: &[Step]) -> String {
    let mut svg = open_svg("error of the image against time");
    let ends = |value: &dyn Fn(&Step) -> f64| {
        steps
            .iter()
            .map(value)
            .fold((f64::MAX, 0.0_f64), |(low, high), x| {
                (low.min(x.max(1e-9)), high.max(x.max(1e-9)))
            })
    };
    let (fastest, slowest) = ends(&|step| step.milliseconds);
    let (least, most) = ends(&|step| step.error);
    let across =
        |x: f64, low: f64, high: f64| (x.max(1e-9) / low).ln() / (high / low).ln().max(1e-9);
    let place = |step: &Step| {
        (
            LEFT + across(step.milliseconds, fastest, slowest) * (WIDTH - LEFT - RIGHT),
            y_of(across(step.error, least, most)),
        )
    };
    for error in [least, (least * most).sqrt(), most] {
        axis_line(
            &mut svg,
            &format!("{:.2} %", 100.0 * error),
            y_of(across(error, least, most)),
        );
    }
    for time in [fastest, (fastest * slowest).sqrt(), slowest] {
        // Writing to a String cannot fail.
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{time:.3}</text>",
            LEFT + across(time, fastest, slowest) * (WIDTH - LEFT - RIGHT),
            HEIGHT - BOTTOM + 16.0,
        );
    }
    let _ = write!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">milliseconds</text>",
        0.5 * (LEFT + WIDTH - RIGHT),
        HEIGHT - 8.0,
    );
    let mut all: Vec<&str> = steps.iter().map(Step::series).collect();
    all.dedup();
    for (index, series) in all.iter().enumerate() {
        let color = COLORS[(index + 1) % COLORS.len()];
        let mut path = String::new();
        for step in steps.iter().filter(|step| step.series() == *series) {
            let (x, y) = place(step);
            let _ = write!(
                path,
                "{}{x:.1} {y:.1}",
                if path.is_empty() { "M" } else { " L" }
            );
            let _ = write!(
                svg,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{color}\"/>"
            );
        }
        let _ = write!(
            svg,
            "<path d=\"{path}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.6\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" style=\"fill:{color}\">{}</text>",
            WIDTH - RIGHT + 8.0,
            TOP + 16.0 * (index + 1) as f64,
            escape(series),
        );
    }
    svg + "</svg>"
}

/// Points against time, both lower the better, with the line through those that no other beats in
/// both.
fn against_time(points: &[Point], time: &str, what: &str, ticks: &[(&str, f64)]) -> String {
    let fastest = points.iter().map(|p| p.fastest).fold(f64::MAX, f64::min);
    let slowest = points.iter().map(|p| p.slowest).fold(0.0, f64::max);
    let (low, high) = (
        (0.8 * fastest).max(1e-6).ln(),
        (1.25 * slowest).max(1e-5).ln(),
    );
    let x = |time: f64| LEFT + (time.max(1e-9).ln() - low) / (high - low) * (WIDTH - LEFT - RIGHT);
    let mut svg = open_svg(&format!("{what} against {time}"));
    for (label, height) in ticks {
        axis_line(&mut svg, label, y_of(*height));
    }
    let decades = (high - low) / 10.0_f64.ln();
    let steps: &[f64] = if decades > 2.5 {
        &[1.0]
    } else {
        &[1.0, 2.0, 5.0]
    };
    let mut decade = 10.0_f64.powf((low / 10.0_f64.ln()).floor());
    while decade.ln() < high {
        for step in steps {
            let time = decade * step;
            if time.ln() > low && time.ln() < high {
                let at = x(time);
                // Writing to a String cannot fail.
                let _ = write!(
                    svg,
                    "<line x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{TOP}\" y2=\"{:.1}\" stroke=\"#eee\"/>\
                     <text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                    HEIGHT - BOTTOM,
                    HEIGHT - BOTTOM + 16.0,
                    short(time),
                );
            }
        }
        decade *= 10.0;
    }
    let _ = write!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{time}</text>\
         <text x=\"14\" y=\"{:.1}\" text-anchor=\"middle\" transform=\"rotate(-90 14 {:.1})\">{what}</text>",
        0.5 * (LEFT + WIDTH - RIGHT),
        HEIGHT - 8.0,
        0.5 * (TOP + HEIGHT - BOTTOM),
        0.5 * (TOP + HEIGHT - BOTTOM),
    );

    let places: Vec<(f64, f64)> = points.iter().map(|p| (x(p.time), y_of(p.height))).collect();
    // The Pareto line, from the cheapest to the most accurate.
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| places[*a].0.total_cmp(&places[*b].0));
    let mut best = f64::MIN;
    let mut path = String::new();
    for index in order {
        let (x, y) = places[index];
        if y > best {
            best = y;
            let _ = write!(
                path,
                "{}{x:.1} {y:.1}",
                if path.is_empty() { "M" } else { " L" }
            );
        }
    }
    let _ = write!(
        svg,
        "<path d=\"{path}\" fill=\"none\" stroke=\"#999\" stroke-dasharray=\"4 3\"/>"
    );
    for (index, (point, (x0, y0))) in points.iter().zip(&places).enumerate() {
        let _ = write!(
            svg,
            "<line x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{y0:.1}\" y2=\"{y0:.1}\" stroke=\"{color}\"/>\
             <circle cx=\"{x0:.1}\" cy=\"{y0:.1}\" r=\"4.5\" fill=\"{color}\"/>",
            x(point.fastest),
            x(point.slowest),
            color = COLORS[index % COLORS.len()],
        );
    }
    let ends: Vec<f64> = points.iter().map(|p| x(p.slowest)).collect();
    write_labels(&mut svg, points, &places, &ends);
    svg + "</svg>"
}

/// Writes each label beside its point, whose bar ends at `ends`, at the nearest height at which it
/// overlaps no other.
fn write_labels(svg: &mut String, points: &[Point], places: &[(f64, f64)], ends: &[f64]) {
    const LINE: f64 = 14.0;
    // Occupied boxes: left, right and height of the middle. The points themselves count.
    let mut taken: Vec<(f64, f64, f64)> =
        places.iter().map(|(x, y)| (x - 6.0, x + 6.0, *y)).collect();
    for (index, (point, (x0, y0))) in points.iter().zip(places).enumerate() {
        // Right of the bar that shows the spread.
        let left = (x0 + 8.0).max(ends[index] + 3.0);
        let right = left + 6.6 * point.label.chars().count() as f64;
        let is_free = |y: f64, taken: &[(f64, f64, f64)]| {
            (TOP..HEIGHT - BOTTOM + 4.0).contains(&y)
                && taken
                    .iter()
                    .all(|(l, r, at)| *r < left || *l > right || (at - y).abs() >= LINE - 1.0)
        };
        let y = (0..20)
            .flat_map(|step| [-1.0, 1.0].map(|side| y0 + side * f64::from(step) * 0.5 * LINE))
            .find(|y| is_free(*y, &taken))
            .unwrap_or(*y0);
        taken.push((left, right, y));
        let color = COLORS[index % COLORS.len()];
        if (y - y0).abs() > 1.0 {
            let _ = write!(
                svg,
                "<line x1=\"{x0:.1}\" y1=\"{y0:.1}\" x2=\"{left:.1}\" y2=\"{y:.1}\" stroke=\"{color}\" stroke-width=\".6\"/>"
            );
        }
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" style=\"fill:{color}\">{}</text>",
            left + 1.0,
            y + 4.0,
            escape(&point.label),
        );
    }
}

fn histograms(rungs: &[Row<'_>]) -> String {
    let mut svg = open_svg("share of the hits by error in ulp");
    let plot = WIDTH - LEFT - RIGHT;
    // The vertical axis is the share, logarithmic from a millionth to one.
    let y = |share: f64| {
        HEIGHT - BOTTOM - (1.0 + share.max(1e-6).log10() / 6.0) * (HEIGHT - TOP - BOTTOM)
    };
    for (label, share) in [
        ("100 %", 1.0),
        ("1 %", 1e-2),
        ("0.01 %", 1e-4),
        ("10⁻⁶", 1e-6),
    ] {
        axis_line(&mut svg, label, y(share));
    }
    let x = |bucket: usize| LEFT + bucket as f64 / 33.0 * plot;
    for (label, bucket) in [("0", 0), ("1", 1), ("2⁸", 9), ("2¹⁶", 17), ("2²⁴", 25)] {
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
            x(bucket),
            HEIGHT - BOTTOM + 16.0
        );
    }
    let _ = write!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">error of t, ulp</text>",
        LEFT + 0.5 * plot,
        HEIGHT - 8.0
    );
    for (index, row) in rungs.iter().enumerate() {
        let counts = row.measured.histogram.iter().map(|count| *count as f64);
        let total = counts.sum::<f64>().max(1.0);
        let mut path = String::new();
        for (bucket, count) in row.measured.histogram.iter().enumerate() {
            let share = *count as f64 / total;
            let _ = write!(
                path,
                "{}{:.1} {:.1}",
                if bucket == 0 { "M" } else { " L" },
                x(bucket.min(33)),
                y(share)
            );
        }
        let color = COLORS[index % COLORS.len()];
        let _ = write!(
            svg,
            "<path d=\"{path}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.6\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" style=\"fill:{color}\">{}</text>",
            WIDTH - RIGHT + 8.0,
            TOP + 16.0 * (index + 1) as f64,
            escape(row.rung),
        );
    }
    svg + "</svg>"
}

/// The inputs with the largest errors, as the bits of their floats.
fn worst_inputs(rungs: &[Row<'_>]) -> String {
    let mut html = String::from(
        "<table><tr><th>rung</th><th>largest ulp</th><th>found</th><th>true</th><th>origin</th><th>direction</th><th>centre, radius</th></tr>",
    );
    for row in rungs {
        let Some(worst) = &row.measured.worst else {
            continue;
        };
        let bits = |words: &[u32]| {
            let words: Vec<String> = words.iter().map(|word| format!("{word:08x}")).collect();
            words.join(" ")
        };
        let _ = write!(
            html,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td><code>{}</code></td><td><code>{}</code></td><td><code>{}</code></td></tr>",
            escape(row.rung),
            ulp::shown(row.measured.max_ulp_anywhere),
            parameter(worst.found),
            parameter(worst.truth),
            bits(&worst.ray[..3]),
            bits(&worst.ray[3..]),
            bits(&worst.sphere),
        );
    }
    html + "</table>"
}

/// A parameter along a ray, with all of its digits.
fn parameter(t: f32) -> String {
    if (1e-3..1e6).contains(&t.abs()) {
        t.to_string()
    } else {
        format!("{t:e}")
    }
}

fn open_svg(title: &str) -> String {
    format!(
        "<svg width=\"{WIDTH}\" height=\"{HEIGHT}\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\"><title>{title}</title>"
    )
}

fn axis_line(svg: &mut String, label: &str, y: f64) {
    let _ = write!(
        svg,
        "<line x1=\"{LEFT}\" x2=\"{:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\" stroke=\"#ddd\"/>\
         <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
        WIDTH - RIGHT,
        LEFT - 6.0,
        y + 4.0,
    );
}

fn short(time: f64) -> String {
    if time >= 1.0 {
        format!("{time:.0}")
    } else {
        format!("{time}").trim_end_matches('0').to_owned()
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
