//! Error against time as a small SVG: logarithmic axes, one colour per control, the Pareto front as a line.

use super::Point;
use std::fmt::Write;

const SIZE: [f64; 2] = [960.0, 600.0];
/// Left, top, right, bottom of the plot within the picture; the legend stands to the right.
const FRAME: [f64; 4] = [70.0, 40.0, 660.0, 540.0];
/// Colours that people with any colour vision can tell apart (Okabe and Ito 2008), and one more.
const COLOURS: [&str; 8] = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#8a6d00", "#555555"];
/// Errors below this are drawn on it.
const LEAST: f64 = 1e-5;

/// A logarithmic axis.
struct Axis {
    from: f64,
    to: f64,
    at: [f64; 2],
}

impl Axis {
    /// Holds `values` with some room, between two places of the picture.
    fn new(values: impl Iterator<Item = f64>, at: [f64; 2]) -> Self {
        let (low, high) = values
            .map(|v| libm::log10(v.max(LEAST)))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        let room = 0.06 * (high - low).max(0.5);
        Self { from: low - room, to: high + room, at }
    }

    fn place(&self, value: f64) -> f64 {
        let share = (libm::log10(value.max(LEAST)) - self.from) / (self.to - self.from);
        self.at[0] + share * (self.at[1] - self.at[0])
    }

    /// 1, 2 and 5 of every power of ten on the axis.
    fn ticks(&self) -> impl Iterator<Item = f64> {
        let (from, to) = (self.from, self.to);
        ((from.floor() as i32)..=(to.ceil() as i32))
            .flat_map(|power| [1.0, 2.0, 5.0].map(|m| m * libm::exp10(f64::from(power))))
            .filter(move |&v| (from..=to).contains(&libm::log10(v)))
    }
}

/// One mark on the plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Dot {
    /// What it belongs to: dots of a group have a colour.
    pub group: String,
    /// Whether only its outline is drawn.
    pub open: bool,
    /// Stands beside it; it is then a black diamond of no group.
    pub name: Option<&'static str>,
    /// What it says when pointed at.
    pub label: String,
    /// Time, ms.
    pub ms: f64,
    /// Error.
    pub error: f64,
    /// Whether nothing is quicker and closer.
    pub pareto: bool,
}

/// What the legend says of a sweep.
const OF_SWEEP: [&str; 3] =
    ["open: changed from preview", "full: changed from final", "dashed: nothing is quicker and closer"];

/// The plot of a sweep.
pub fn svg(title: &str, error: &str, points: &[Point]) -> String {
    let dot = |point: &Point| {
        let (of, control) = point.sweep.split_once(": ").unwrap_or(("", &point.sweep));
        Dot {
            group: control.to_owned(),
            // Changes to the preview are open, those to the final full.
            open: of == "preview",
            name: point.defaults,
            label: format!("{} = {}: {:.0} ms, FLIP {:.4}", point.sweep, point.value, point.ms, point.flip),
            ms: point.ms,
            error: point.flip,
            pareto: point.pareto,
        }
    };
    draw([title, error], &points.iter().map(dot).collect::<Vec<_>>(), &OF_SWEEP)
}

/// A plot of dots, with its title and what its errors are; `notes` stand under the legend.
pub fn draw([title, error]: [&str; 2], dots: &[Dot], notes: &[&str]) -> String {
    let [left, top, right, bottom] = FRAME;
    let x = Axis::new(dots.iter().map(|p| p.ms), [left, right]);
    let y = Axis::new(dots.iter().map(|p| p.error), [bottom, top]);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"{left}\" y=\"24\" font-size=\"15\">{}</text>\n",
        SIZE[0],
        SIZE[1],
        escaped(title)
    );
    axes(&mut out, &x, &y, error);
    let mut front: Vec<&Dot> = dots.iter().filter(|p| p.pareto).collect();
    front.sort_by(|a, b| a.ms.total_cmp(&b.ms));
    let line: Vec<String> = front.iter().map(|p| format!("{:.1},{:.1}", x.place(p.ms), y.place(p.error))).collect();
    line_out(&mut out, &line);
    let mut groups: Vec<&str> = Vec::new();
    for dot in dots {
        let (px, py) = (x.place(dot.ms), y.place(dot.error));
        let label = escaped(&dot.label);
        if let Some(name) = dot.name {
            push(
                &mut out,
                format_args!(
                    "<path d=\"M{px:.1} {:.1}l7 7 -7 7 -7 -7z\" fill=\"black\"><title>{label}</title></path>\n\
                 <text x=\"{:.1}\" y=\"{:.1}\" font-weight=\"bold\">{name}</text>\n",
                    py - 7.0,
                    px + 10.0,
                    py - 6.0
                ),
            );
            continue;
        }
        let index = groups.iter().position(|&group| group == dot.group).unwrap_or_else(|| {
            groups.push(&dot.group);
            groups.len() - 1
        });
        let colour = COLOURS[index % COLOURS.len()];
        let fill = if dot.open { "white" } else { colour };
        let width = if dot.pareto { 2.5 } else { 1.2 };
        push(
            &mut out,
            format_args!(
                "<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"4\" fill=\"{fill}\" stroke=\"{colour}\" \
             stroke-width=\"{width}\"><title>{label}</title></circle>\n"
            ),
        );
    }
    legend(&mut out, &groups, notes);
    out.push_str("</svg>\n");
    out
}

/// Formatting into a `String` cannot fail.
fn push(out: &mut String, text: std::fmt::Arguments<'_>) {
    let _ = out.write_fmt(text);
}

fn line_out(out: &mut String, line: &[String]) {
    push(
        out,
        format_args!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"#999999\" stroke-width=\"1.5\" stroke-dasharray=\"5 3\"/>\n",
            line.join(" ")
        ),
    );
}

fn axes(out: &mut String, x: &Axis, y: &Axis, error: &str) {
    let [left, top, right, bottom] = FRAME;
    for value in x.ticks() {
        let at = x.place(value);
        push(
            out,
            format_args!(
                "<path d=\"M{at:.1} {top}V{bottom}\" stroke=\"#eeeeee\"/><text x=\"{at:.1}\" y=\"{}\" \
             text-anchor=\"middle\">{value}</text>\n",
                bottom + 18.0
            ),
        );
    }
    for value in y.ticks() {
        let at = y.place(value);
        push(
            out,
            format_args!(
                "<path d=\"M{left} {at:.1}H{right}\" stroke=\"#eeeeee\"/><text x=\"{}\" y=\"{:.1}\" \
             text-anchor=\"end\">{value}</text>\n",
                left - 6.0,
                at + 4.0
            ),
        );
    }
    push(
        out,
        format_args!(
            "<rect x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#333333\"/>\n\
         <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">time, ms</text>\n\
         <text transform=\"translate(18 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
            right - left,
            bottom - top,
            0.5 * (left + right),
            bottom + 40.0,
            0.5 * (top + bottom),
            escaped(error)
        ),
    );
}

fn legend(out: &mut String, groups: &[&str], notes: &[&str]) {
    let x = FRAME[2] + 24.0;
    let mut y = FRAME[1] + 8.0;
    for (i, group) in groups.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        push(
            out,
            format_args!(
                "<circle cx=\"{x}\" cy=\"{}\" r=\"4\" fill=\"{colour}\"/><text x=\"{}\" y=\"{y}\">{}</text>\n",
                y - 4.0,
                x + 12.0,
                escaped(group)
            ),
        );
        y += 20.0;
    }
    for note in notes {
        y += 18.0;
        push(out, format_args!("<text x=\"{x}\" y=\"{y}\" fill=\"#555555\">{note}</text>\n"));
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
