//! One tile of the picture: rays through undercoat, ribbons of guard hair, and both in one order.

use super::Settings;
use super::brush::Brush;
use super::film::FilmRows;
use super::gather::{Gathered, Stroke};
use super::pass::{Band, Pass};
use super::undercoat::{self, PixelJourney};
use crate::data::film::Layers;
use crate::data::strands::Strands;
use crate::math::{Vec2, Vec3};
use crate::math::{lanes, radix};
use crate::render::bins::TILE;
use crate::render::flat::{self, Flat, pixel_ray};
use crate::render::march::enter::Entrances;
use crate::render::march::{Journey, Start};
use crate::render::resolve::{self, Blending, Face, Stretch};
use crate::render::skin::{self, NONE, SkinTile};
use crate::render::strands::ribbon::Window;
use crate::render::strands::{Fragment, Knot};

/// A tile of the picture.
#[derive(Clone, Copy)]
pub(super) struct Place<'t> {
    /// Index in the band's grid.
    pub(super) in_band: usize,
    /// Index in the whole picture's grid.
    pub(super) in_picture: usize,
    /// Its first pixel.
    pub(super) from: [usize; 2],
    /// One past its last pixel.
    pub(super) to: [usize; 2],
    pub(super) skin: &'t SkinTile,
}

impl Place<'_> {
    /// Where a pixel of the picture lies in the tile.
    #[inline(always)]
    pub(super) fn at(&self, x: usize, y: usize) -> usize {
        (y - self.from[1]) * TILE + x - self.from[0]
    }

    /// Column and row of the picture of a pixel of the tile.
    #[inline(always)]
    pub(super) fn pixel(&self, at: usize) -> [i32; 2] {
        [(self.from[0] + at % TILE) as i32, (self.from[1] + at / TILE) as i32]
    }

    fn pixels(self) -> impl Iterator<Item = (usize, usize, usize)> {
        let columns = self.from[0]..self.to[0];
        (self.from[1]..self.to[1]).flat_map(move |y| columns.clone().map(move |x| (self.at(x, y), x, y)))
    }
}

impl Pass<'_> {
    /// Gathers the fragments of guard hair: nearest pieces first, so that most of those that hide behind them are never
    /// drawn.
    pub(super) fn gather(&self, place: &Place<'_>, band: &Band, scratch: &mut Scratch) {
        let Scratch { guard, pieces, spare, fragment_count, .. } = scratch;
        guard.begin(self.settings.opaque, |at| [self.limit_m(place, at), self.clear_m(place, at)]);
        let Some((strands, _)) = &self.guard else { return };
        pieces.clear();
        // Positive floats are ordered as their bits.
        let nearest_m = |piece: u32| band.knots[piece as usize].z_m.min(band.knots[piece as usize + 1].z_m).max(0.0);
        let keyed = |&piece: &u32| u64::from(nearest_m(piece).to_bits()) << 32 | u64::from(piece);
        pieces.extend(band.bins.of(place.in_band).iter().map(keyed));
        radix::sort(pieces, spare);
        let window = Window { from: place.from.map(|v| v as i32), to: place.to.map(|v| v as i32) };
        lanes::run(Brush { pass: self, strands, place, band, pieces, window, guard });
        *fragment_count += guard.count() as u64;
        guard.settle();
        if self.settings.layers != Layers::Light {
            guard.face(|piece| self.stroke(strands, band, piece));
        }
    }

    /// Depth behind which a pixel's skin hides hair wherever in the pixel it stands, m; infinite where there is none.
    fn limit_m(&self, place: &Place<'_>, at: usize) -> f32 {
        let (x, y) = (place.from[0] + at % TILE, place.from[1] + at / TILE);
        if x >= place.to[0] || y >= place.to[1] {
            return f32::NEG_INFINITY;
        }
        let triangle = place.skin.triangle[at];
        if triangle == NONE {
            return f32::INFINITY;
        }
        let flat = Flat::new(self.corners(triangle));
        let corner_m = |i: usize| {
            let corner = Vec2::new((x + i % 2) as f32, (y + i / 2) as f32);
            let z_m = flat.plane_depth(((corner - self.view.centre_px) / self.view.focal_px).extend(1.0));
            if z_m > 0.0 { z_m } else { f32::INFINITY }
        };
        (0..4).map(corner_m).fold(place.skin.z_m[at], f32::max)
    }

    /// Depth before which hair lies before a pixel's skin wherever in the pixel it stands, m.
    fn clear_m(&self, place: &Place<'_>, at: usize) -> f32 {
        match place.skin.triangle[at] {
            NONE => f32::INFINITY,
            triangle if self.bare[triangle as usize] => f32::NEG_INFINITY,
            _ => place.skin.z_m[at],
        }
    }

    /// Puts what a tile's pixels hold into one order and colours the film.
    pub(super) fn compose(&self, place: &Place<'_>, scratch: &Scratch, out: &mut FilmRows<'_>) {
        lanes::run(Compose { pass: self, place, scratch, out });
    }

    #[inline(always)]
    fn compose_pixels(&self, place: &Place<'_>, scratch: &Scratch, out: &mut FilmRows<'_>) {
        let Settings { layers, blending, opaque, .. } = *self.settings;
        for (at, x, y) in place.pixels() {
            scratch.guard.call((at + 1) % (TILE * TILE));
            let skin_face = || self.skin_face(x, y, place.skin.triangle[at]);
            let face = |f: &Fragment| self.hair_face(f, &scratch.guard);
            let (mut fragments, stretches) = (scratch.guard.of(at), &scratch.stretches[at]);
            if let Blending::Simplified { .. } = blending {
                // Hair thins the undercoat before it, but only as far as that lets it be seen.
                fragments = &fragments[..fragments.partition_point(|f| f.z_m() <= scratch.opaque_m[at])];
            }
            let pixel = resolve::composite(layers, fragments, stretches, blending, opaque, skin_face, face);
            let depth_scale = pixel_ray(&self.view, x, y).length();
            out.add(y - place.from[1], x, &pixel, depth_scale);
        }
    }

    /// Marches the rays of one tile through the undercoat, as far as what [`Self::gather`] found lets it be seen.
    pub(super) fn march(&self, entrances: &Entrances, place: &Place<'_>, scratch: &mut Scratch) {
        let Some((volume, shader)) = &self.undercoat else { return };
        let Scratch { starts, journeys, stretches, opaque_m, guard, step_count, .. } = scratch;
        for (face, corners) in entrances.of_tile(place.in_picture) {
            let flat = Flat::new(corners);
            let [columns, rows] = self.pixels(&flat::reach(&self.view, &corners));
            for y in rows.start.max(place.from[1])..rows.end.min(place.to[1]) {
                for x in columns.start.max(place.from[0])..columns.end.min(place.to[0]) {
                    let at = place.at(x, y);
                    let ray = pixel_ray(&self.view, x, y);
                    if let Some(meeting) = flat.meet(ray)
                        && flat.faces_eye()
                        && meeting.z_m < place.skin.z_m[at]
                    {
                        let direction = self.view.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5)).normalize();
                        let ray_m = [self.view.eye_m, direction];
                        let at_m = meeting.z_m * ray.length();
                        starts[at].push(entrances.start(volume.shell(), face, meeting.barycentric, at_m, ray_m));
                    }
                }
            }
        }
        let mut most = 0;
        for (at, ..) in place.pixels() {
            let starts = &mut starts[at];
            starts.extend(entrances.around_eye());
            // Faces that meet on a ray give one entrance each: the next march begins where the last one ended.
            starts.sort_unstable_by(|a, b| a.at_m.total_cmp(&b.at_m).then(a.triangle.cmp(&b.triangle)));
            starts.dedup_by(|next, kept| next.at_m - kept.at_m < 1e-6 * kept.at_m);
            most = most.max(starts.len());
            if let Blending::Virtual { .. } = self.settings.blending {
                opaque_m[at] = guard.limit_m(at);
            }
        }
        let (fragments, veiled) = match self.settings.blending {
            Blending::Virtual { fragments } => (fragments, Some(&*guard)),
            Blending::Simplified { .. } => (1, None),
        };
        // The first march of every pixel, then the second: what lies behind an opaque one is not followed.
        for rank in 0..most {
            journeys.clear();
            for (at, x, y) in place.pixels() {
                let Some(&start) = starts[at].get(rank) else { continue };
                let direction = self.view.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
                let scale = direction.length();
                let far_m = opaque_m[at].min(place.skin.z_m[at]) * scale;
                if start.at_m < far_m {
                    let journey = Journey { origin_m: self.view.eye_m, direction: direction / scale, start, far_m };
                    journeys.push(PixelJourney { pixel: at as u32, z_per_m: 1.0 / scale, journey });
                }
            }
            *step_count += lanes::run(undercoat::Look {
                volume,
                shader,
                stepping: &self.settings.stepping,
                fragments,
                opaque: self.settings.opaque,
                veiled,
                journeys,
                stretches,
                opaque_m,
                layers: self.settings.layers,
            });
        }
        // Marches of one pixel may pass through one another.
        if most > 1 {
            stretches.iter_mut().for_each(|some| some.sort_by(|a, b| a.from_m.total_cmp(&b.from_m)));
        }
    }

    /// Whether a hair lies before the skin. On slanting skin, half of the roots lie behind the skin of the pixel's middle:
    /// they count where they lie before the skin of their own place. Seen from its bare side, skin hides what lies behind
    /// either.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "a piece, where on it, and the pixel")]
    pub(super) fn before_skin(
        &self,
        a: &Knot,
        b: &Knot,
        linear: f32,
        pixel: [i32; 2],
        z_m: f32,
        skin: &SkinTile,
        at: usize,
    ) -> bool {
        let (triangle, before_middle) = (skin.triangle[at], z_m < skin.z_m[at]);
        // Planes are asked for only where they decide.
        if triangle == NONE || before_middle != self.bare[triangle as usize] {
            return before_middle;
        }
        self.before_plane(a, b, linear, pixel, z_m, triangle)
    }

    /// Whether a hair lies before the plane of a triangle, at its own place within the pixel.
    #[inline(never)]
    fn before_plane(&self, a: &Knot, b: &Knot, linear: f32, pixel: [i32; 2], z_m: f32, triangle: u32) -> bool {
        let at = |from: f32, to: f32, pixel: i32| (from + linear * (to - from)).clamp(pixel as f32, (pixel + 1) as f32);
        let pixel = Vec2::new(at(a.x, b.x, pixel[0]), at(a.y, b.y, pixel[1]));
        let ray = ((pixel - self.view.centre_px) / self.view.focal_px).extend(1.0);
        z_m < Flat::new(self.corners(triangle)).plane_depth(ray)
    }

    fn skin_face(&self, x: usize, y: usize, triangle: u32) -> Option<Face> {
        if triangle == NONE {
            return None;
        }
        let meeting = Flat::new(self.corners(triangle)).meet(pixel_ray(&self.view, x, y))?;
        let direction = self.view.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
        let (b, z_m) = (meeting.barycentric, meeting.z_m);
        Some(skin::look(self.pelt, self.lighting, self.normals, self.mean, triangle, b, direction, z_m))
    }

    /// What all fragments of a piece have in common.
    fn stroke(&self, strands: &Strands, band: &Band, piece: u32) -> Stroke {
        let points = strands.points_per_strand;
        let (strand, first) = (band.strands[piece as usize / points] as usize, piece as usize % points);
        let points_m = strands.points_of_m(strand);
        Stroke { tangent: (points_m[first + 1] - points_m[first]).normalize_or_zero(), tint: strands.tint[strand] }
    }

    #[inline(always)]
    fn hair_face(&self, fragment: &Fragment, guard: &Gathered) -> Face {
        let streak = guard.streak(fragment);
        let Some((strands, _)) = self.guard.as_ref().filter(|_| self.settings.layers != Layers::Light) else {
            return Face { radiance: streak.radiance, ..Face::default() };
        };
        let stroke = guard.stroke(streak);
        Face {
            z_m: fragment.z_m(),
            radiance: streak.radiance,
            albedo: stroke.tint * strands.profile.ramp_at(guard.along(fragment)),
            tangent: stroke.tangent,
            normal: Vec3::ZERO,
        }
    }
}

/// Colours the pixels of a tile, by the instructions of the machine at hand.
struct Compose<'a, 'p, 'f> {
    pass: &'a Pass<'p>,
    place: &'a Place<'a>,
    scratch: &'a Scratch,
    out: &'a mut FilmRows<'f>,
}

impl lanes::Work for Compose<'_, '_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<I: lanes::Isa>(self) {
        self.pass.compose_pixels(self.place, self.scratch, self.out);
    }
}

/// What a tile's pixels hold, kept between tiles for its memory.
pub(super) struct Scratch {
    guard: Gathered,
    /// Depth's bits and index of each piece in the tile.
    pieces: Vec<u64>,
    spare: Vec<u64>,
    starts: Vec<Vec<Start>>,
    journeys: Vec<PixelJourney>,
    stretches: Vec<Vec<Stretch>>,
    /// Depth from which on no undercoat is seen, m.
    opaque_m: Vec<f32>,
    pub(super) fragment_count: u64,
    pub(super) step_count: u64,
    /// Time spent on ribbons, marching and compositing, ns.
    pub(super) spent_ns: [u64; 3],
}

impl Scratch {
    /// Forgets the last tile.
    pub(super) fn clear(&mut self) {
        self.starts.iter_mut().for_each(Vec::clear);
        self.stretches.iter_mut().for_each(Vec::clear);
        self.opaque_m.fill(f32::INFINITY);
    }
}

impl Default for Scratch {
    fn default() -> Self {
        const SIZE: usize = TILE * TILE;
        Self {
            guard: Gathered::default(),
            pieces: Vec::new(),
            spare: Vec::new(),
            starts: vec![Vec::new(); SIZE],
            journeys: Vec::new(),
            stretches: vec![Vec::new(); SIZE],
            opaque_m: vec![f32::INFINITY; SIZE],
            fragment_count: 0,
            step_count: 0,
            spent_ns: [0; 3],
        }
    }
}
