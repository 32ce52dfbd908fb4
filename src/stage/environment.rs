//! Surrounding light: equirectangular HDR maps, and the few directional lights that stand for one.

use crate::data::light::{Directional, luminance};
use crate::error::{Error, Result};
use crate::math::Vec3;
use std::f32::consts::{PI, TAU};
use std::path::Path;

/// An equirectangular map: columns go once around +Y, rows from up (+Y) to down. The middle column looks along −Z.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Radiance, linear RGB, `width * height` values; finite, none negative.
    pub radiance: Vec<Vec3>,
}

/// No map needs more; a lying header must not fill the memory.
const MOST_PIXELS: usize = 1 << 27;

impl Environment {
    /// A map of the given size.
    ///
    /// # Errors
    /// Names a size that does not fit the pixels, or the first pixel that is negative or not finite.
    pub fn new(width: usize, height: usize, radiance: Vec<Vec3>) -> Result<Self> {
        if width == 0 || height == 0 || radiance.len() != width * height {
            return Err(Error::input("the environment map's size does not fit its pixels")
                .with_field("size")
                .with_found(format!("{width} x {height}, {} pixels", radiance.len()))
                .with_expected("width times height pixels, at least one"));
        }
        if let Some(i) = radiance.iter().position(|p| !p.is_finite() || p.min_element() < 0.0) {
            return Err(Error::input("the environment map holds a value that no light has")
                .with_field(format!("pixel ({}, {})", i % width, i / width))
                .with_found(radiance[i])
                .with_expected("finite numbers, none negative"));
        }
        Ok(Self { width, height, radiance })
    }

    /// Reads a Radiance `.hdr` or an `.exr` file.
    ///
    /// # Errors
    /// Names the file and what is wrong with it.
    pub fn read(path: &Path) -> Result<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        let read = match extension.as_str() {
            "hdr" => std::fs::read(path)
                .map_err(|e| Error::input("the environment map cannot be read").with_found(e))
                .and_then(|bytes| radiance_picture(&bytes)),
            "exr" => exr_picture(path),
            _ => Err(Error::input("the environment map is of an unknown kind")
                .with_found(format!(".{extension}"))
                .with_expected(".hdr or .exr")),
        };
        read.and_then(|(width, height, pixels)| Self::new(width, height, pixels)).map_err(|e| e.with_file(path))
    }

    /// Solid angle of a pixel in `row`, sr; all rows together hold 4π.
    pub fn solid_angle_sr(&self, row: usize) -> f32 {
        let edge = |r: usize| libm::cosf(PI * r as f32 / self.height as f32);
        TAU / self.width as f32 * (edge(row) - edge(row + 1))
    }

    /// Unit vector towards the point (x, y) of the map, in pixels.
    pub fn direction(&self, x: f32, y: f32) -> Vec3 {
        let azimuth = TAU * (x / self.width as f32 - 0.5);
        let polar = PI * y / self.height as f32;
        let across = libm::sinf(polar);
        Vec3::new(across * libm::sinf(azimuth), libm::cosf(polar), -across * libm::cosf(azimuth))
    }

    /// At most `count` lights of about equal power that stand for the map, by median cut (Debevec 2005, "A median cut
    /// algorithm for light probe sampling"): the widest way across each region, measured on the sphere, is halved
    /// in power, and each light stands at its region's centre of power.
    ///
    /// Their irradiances sum to the map's ∫ L dω. Dark regions give no light.
    pub fn median_cut(&self, count: usize) -> Vec<Directional> {
        let mut regions = vec![MapRegion { x: [0, self.width], y: [0, self.height] }];
        while regions.len() < count {
            // The most powerful region that can be cut.
            let Some(i) = (0..regions.len())
                .filter(|&i| regions[i].pixels() > 1)
                .max_by(|&a, &b| self.power(&regions[a]).total_cmp(&self.power(&regions[b])).then(b.cmp(&a)))
            else {
                break;
            };
            let (first, second) = self.halve(&regions[i]);
            regions[i] = first;
            regions.push(second);
        }
        regions.iter().filter_map(|region| self.light(region)).collect()
    }

    fn power_of_pixel(&self, x: usize, y: usize) -> f64 {
        f64::from(luminance(self.radiance[y * self.width + x]) * self.solid_angle_sr(y))
    }

    fn power(&self, region: &MapRegion) -> f64 {
        let (x, y) = (region.x, region.y);
        (y[0]..y[1]).map(|row| (x[0]..x[1]).map(|column| self.power_of_pixel(column, row)).sum::<f64>()).sum()
    }

    fn halve(&self, region: &MapRegion) -> (MapRegion, MapRegion) {
        let [x0, x1] = region.x;
        let [y0, y1] = region.y;
        let middle = 0.5 * (y0 + y1) as f32 / self.height as f32;
        let across = (x1 - x0) as f32 * TAU / self.width as f32 * libm::sinf(PI * middle);
        let down = (y1 - y0) as f32 * PI / self.height as f32;
        if x1 - x0 > 1 && (across >= down || y1 - y0 == 1) {
            let at = self.median(x0, x1, |x| (y0..y1).map(|y| self.power_of_pixel(x, y)).sum());
            (MapRegion { x: [x0, at], y: region.y }, MapRegion { x: [at, x1], y: region.y })
        } else {
            let at = self.median(y0, y1, |y| (x0..x1).map(|x| self.power_of_pixel(x, y)).sum());
            (MapRegion { x: region.x, y: [y0, at] }, MapRegion { x: region.x, y: [at, y1] })
        }
    }

    /// The cut in (from, to) after which at least half of the power has passed.
    fn median(&self, from: usize, to: usize, power: impl Fn(usize) -> f64) -> usize {
        let slices: Vec<f64> = (from..to).map(power).collect();
        let half = 0.5 * slices.iter().sum::<f64>();
        let mut passed = 0.0;
        let at = slices.iter().position(|slice| {
            passed += slice;
            passed >= half
        });
        (from + at.unwrap_or(0) + 1).clamp(from + 1, to - 1)
    }

    fn light(&self, region: &MapRegion) -> Option<Directional> {
        let (mut irradiance, mut towards) = (Vec3::ZERO, Vec3::ZERO);
        for y in region.y[0]..region.y[1] {
            let solid_angle = self.solid_angle_sr(y);
            for x in region.x[0]..region.x[1] {
                let arriving = self.radiance[y * self.width + x] * solid_angle;
                irradiance += arriving;
                towards += luminance(arriving) * self.direction(x as f32 + 0.5, y as f32 + 0.5);
            }
        }
        let to_light = towards.normalize_or_zero();
        (to_light != Vec3::ZERO).then_some(Directional { to_light, irradiance })
    }
}

struct MapRegion {
    x: [usize; 2],
    y: [usize; 2],
}

impl MapRegion {
    fn pixels(&self) -> usize {
        (self.x[1] - self.x[0]) * (self.y[1] - self.y[0])
    }
}

type Picture = (usize, usize, Vec<Vec3>);

fn broken(what: &str, found: impl std::fmt::Display, expected: &str) -> Error {
    Error::input("the environment map is broken").with_field(what).with_found(found).with_expected(expected)
}

fn checked_size(width: usize, height: usize) -> Result<usize> {
    match width.checked_mul(height) {
        Some(pixels) if (1..=MOST_PIXELS).contains(&pixels) => Ok(pixels),
        _ => Err(broken("size", format!("{width} x {height}"), "1 to 2^27 pixels")),
    }
}

/// Ward's shared-exponent picture (Ward 1991, "Real pixels"), run-length coded by row or plain.
fn radiance_picture(bytes: &[u8]) -> Result<Picture> {
    if !bytes.starts_with(b"#?") {
        return Err(broken("signature", String::from_utf8_lossy(&bytes[..bytes.len().min(2)]), "#?"));
    }
    let mut at = 0;
    let mut line = || -> Result<&[u8]> {
        let rest = &bytes[at..];
        let length = rest
            .iter()
            .position(|&b| b == b'\n')
            .ok_or_else(|| broken("header", "the end of the file", "a line with the size"))?;
        at += length + 1;
        Ok(&rest[..length])
    };
    while !line()?.is_empty() {}
    let size = String::from_utf8_lossy(line()?).into_owned();
    let words: Vec<&str> = size.split_whitespace().collect();
    let (height, width) = match words[..] {
        ["-Y", height, "+X", width] => (height.parse::<usize>().ok(), width.parse::<usize>().ok()),
        _ => (None, None),
    };
    let (Some(height), Some(width)) = (height, width) else {
        return Err(broken("size", size, "-Y HEIGHT +X WIDTH"));
    };
    let mut pixels = Vec::with_capacity(checked_size(width, height)?.min(8 * bytes.len()));
    let mut rest = &bytes[at..];
    let mut row = vec![[0_u8; 4]; width];
    for y in 0..height {
        rest = radiance_row(rest, &mut row)
            .ok_or_else(|| broken(&format!("row {y}"), "data that ends early or overruns", "whole rows"))?;
        pixels.extend(row.iter().map(|&[r, g, b, e]| {
            let scale = if e == 0 { 0.0 } else { libm::ldexpf(1.0, i32::from(e) - 136) };
            Vec3::new(f32::from(r), f32::from(g), f32::from(b)) * scale
        }));
    }
    Ok((width, height, pixels))
}

fn radiance_row<'a>(mut rest: &'a [u8], row: &mut [[u8; 4]]) -> Option<&'a [u8]> {
    let width = row.len();
    let marker = [2, 2, (width >> 8) as u8, width as u8];
    if !(8..0x8000).contains(&width) || rest.get(..4)? != marker {
        for pixel in row {
            let (head, tail) = rest.split_first_chunk::<4>()?;
            (*pixel, rest) = (*head, tail);
        }
        return Some(rest);
    }
    rest = &rest[4..];
    for channel in 0..4 {
        let mut x = 0;
        while x < width {
            let (&code, tail) = rest.split_first()?;
            let run = if code > 128 { usize::from(code) - 128 } else { usize::from(code) };
            if run == 0 || x + run > width {
                return None;
            }
            let same = code > 128;
            let values = tail.get(..if same { 1 } else { run })?;
            for (i, pixel) in row[x..x + run].iter_mut().enumerate() {
                pixel[channel] = values[if same { 0 } else { i }];
            }
            rest = &tail[values.len()..];
            x += run;
        }
    }
    Some(rest)
}

fn exr_picture(path: &Path) -> Result<Picture> {
    use exr::prelude::*;
    let unreadable = |e: exr::error::Error| {
        crate::stage::environment::Error::input("the environment map cannot be read")
            .with_field("EXR")
            .with_found(e)
            .with_expected("a whole OpenEXR picture in RGB")
    };
    // Before room is made for pixels that a lying header only claims to have.
    for header in &MetaData::read_from_file(path, false).map_err(unreadable)?.headers {
        checked_size(header.layer_size.width(), header.layer_size.height())?;
    }
    let image = read_first_rgba_layer_from_file(
        path,
        |size, _| (size.width(), vec![Vec3::ZERO; size.area()]),
        |(width, pixels), position, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[position.y() * *width + position.x()] = Vec3::new(r, g, b);
        },
    )
    .map_err(unreadable)?;
    let size = image.layer_data.size;
    Ok((size.width(), size.height(), image.layer_data.channel_data.pixels.1))
}
