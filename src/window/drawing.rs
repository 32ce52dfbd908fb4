//! The thread that draws with the runtime, so that the window answers while it does.

use super::look::{Look, Moment};
use super::mailbox::{Receiver, Sender, mailbox};
use super::model::Model;
use crate::data::image::Image8;
use crate::error::{Error, Kind, Result};
use crate::gpu::{Choice, Gpu};
use crate::math::Vec3;
use crate::runtime::gpu::{Drawn, KeyShadow, PassCost, Passes, Prepared, Renderer};
use crate::runtime::{DrawList, Frame, Motion, Picture, Show, Spring, Wind};
use crate::viewer::bald::{self, Baldness};
use crate::viewer::chart::{self, Chart};
use crate::viewer::cost::{self, Cost};
use crate::viewer::{Combing, channel, step_texels};
use crate::viewer::{Shown, sitting, stage};
use std::sync::Arc;
use std::time::Instant;

/// A picture that is wanted.
pub struct Order {
    /// Of what.
    pub model: Arc<Model>,
    /// How.
    pub look: Look,
    /// Pixels of the picture stand for so many along an edge; 1 at rest.
    pub coarseness: u32,
    /// Whether to count what it reads, which takes a further pass.
    pub count: bool,
    /// What moves its hair; none where it follows the skin alone.
    pub sway: Option<Sway>,
}

/// What moves hair.
#[derive(Clone, Copy, Debug)]
pub struct Sway {
    /// How it swings.
    pub spring: Spring,
    /// What blows.
    pub wind: Wind,
    /// When.
    pub at: Instant,
}

/// A drawn picture.
pub struct Answer {
    /// Of this model.
    pub model: Arc<Model>,
    /// Looked at so.
    pub look: Look,
    /// See [`Order::coarseness`].
    pub coarseness: u32,
    /// Linear light.
    pub picture: Arc<Picture>,
    /// As shown.
    pub image: Image8,
    /// What it cost.
    pub statistics: Statistics,
}

/// What a picture cost.
#[derive(Clone, Debug, Default)]
pub struct Statistics {
    /// By pass.
    pub passes: Vec<PassCost>,
    /// Wall time from camera to picture, ms.
    pub wall_ms: f64,
    /// Of textures, geometry and targets, bytes.
    pub memory: [u64; 3],
    /// Mean level of all coats, 0 being the finest.
    pub level: f32,
    /// Height of the longest hair, pixels of the window.
    pub height_px: f32,
    /// Texels read for each pixel that shows anything; none where it was not counted.
    pub reads: Option<f64>,
    /// As [`step_texels`].
    pub step_texels: f32,
    /// Whether the key light's shadow is missing, as it stands too near.
    pub no_shadow: bool,
    /// What colours mean, one sentence each.
    pub legend: Vec<String>,
    /// What draws.
    pub device: String,
}

/// Starts the thread. `answer` is called on it with each picture or what kept it from being drawn.
///
/// # Errors
/// Where the system has no thread to give.
pub fn start(choice: Choice, answer: impl Fn(Result<Answer>) + Send + 'static) -> Result<Sender<Order>> {
    let (sender, orders) = mailbox();
    let work = move || match Gpu::open(&choice) {
        Ok(gpu) => match Passes::new(&gpu, 1) {
            Ok(passes) => serve(&gpu, &passes, &orders, &answer),
            Err(error) => answer(Err(error)),
        },
        Err(error) => answer(Err(error)),
    };
    std::thread::Builder::new()
        .name("draw".into())
        .spawn(work)
        .map_err(|error| Error::new(Kind::Machine, "the thread that draws cannot be started").with_found(error))?;
    Ok(sender)
}

/// Until nobody orders any more. What failed is told, and the next order awaited.
fn serve(gpu: &Gpu, passes: &Passes, orders: &Receiver<Order>, answer: &dyn Fn(Result<Answer>)) {
    let mut next = orders.take();
    while let Some(order) = next {
        next = draw_model((gpu, passes), order, orders, answer).unwrap_or_else(|error| {
            answer(Err(error));
            orders.take()
        });
    }
}

/// What of an order the geometry hangs on.
fn staging(order: &Order) -> (Option<Moment>, Combing, Option<Chart>, bool) {
    let chart = match order.look.shown {
        Shown::Chart(chart) => Some(chart),
        _ => None,
    };
    (order.look.moment, order.look.combing, chart, order.look.shown == Shown::Bald)
}

/// Draws one model until another is wanted, which is returned.
fn draw_model(
    (gpu, passes): (&Gpu, &Passes),
    mut order: Order,
    orders: &Receiver<Order>,
    answer: &dyn Fn(Result<Answer>),
) -> Result<Option<Order>> {
    let model = Arc::clone(&order.model);
    let renderer = Renderer::with(gpu, passes, &model.coat.tiles)?;
    let outline = chart::tile_outline();
    let (mut motion, mut last) = (Motion::default(), None::<Instant>);
    loop {
        let (staged, swayed) = (staging(&order), order.sway.is_some());
        let pose = match order.look.moment {
            Some(Moment { animation, seconds }) => model.asset.pose(animation, seconds)?,
            None => model.asset.rest_pose()?,
        };
        let (mut scene, legend) = match order.look.shown {
            Shown::Chart(chart) => {
                let chart::Drawing { scene, legend } = chart::draw(&model.asset, &model.coat, &pose, chart, &outline)?;
                (scene, legend)
            }
            _ => (stage::scene(&model.asset, &model.coat, &model.textures, &pose), Vec::new()),
        };
        order.look.combing.comb(&mut scene);
        let step_texels = step_texels(&scene);
        match &order.sway {
            Some(Sway { spring, wind, at }) => {
                let elapsed_s = last.map_or(0.0, |last| at.saturating_duration_since(last).as_secs_f32());
                motion.step(&mut scene, wind, spring, elapsed_s);
                last = Some(*at);
            }
            None => (motion, last) = (Motion::default(), None),
        }
        let over_skin = match order.look.shown {
            Shown::Bald => Some(renderer.prepare(&bald::marked(&scene))?),
            _ => None,
        };
        let points_m = stage::points_m(&scene);
        let prepared = renderer.prepare(&scene)?;
        let mut easel =
            Easel { renderer: &renderer, scene: &scene, prepared, over_skin, points_m, legend, step_texels };
        loop {
            answer(easel.draw(&order, gpu));
            match orders.take() {
                None => return Ok(None),
                Some(other) if !Arc::ptr_eq(&other.model, &model) => return Ok(Some(other)),
                Some(same) => order = same,
            }
            if staging(&order) != staged || swayed || order.sway.is_some() {
                break;
            }
        }
    }
}

/// A pose on the device.
struct Easel<'a> {
    renderer: &'a Renderer<'a>,
    scene: &'a DrawList<'a>,
    prepared: Prepared<'a>,
    /// With what is counted for bald skin.
    over_skin: Option<Prepared<'a>>,
    points_m: Vec<Vec3>,
    legend: Vec<String>,
    step_texels: f32,
}

impl Easel<'_> {
    fn draw(&mut self, order: &Order, gpu: &Gpu) -> Result<Answer> {
        let start = Instant::now();
        let (model, look) = (&order.model, &order.look);
        let coarse = order.coarseness.max(1);
        let size = look.size.map(|edge| edge.div_ceil(coarse).max(1));
        let (lit, shadow_map) = match look.shown {
            Shown::Chart(chart) => (chart::lit(chart, -look.camera.axes()[2].as_vec3()), false),
            _ => (look.lighting.lit(&model.subject, &look.camera)?, look.lighting.shadow),
        };
        let frame = Frame {
            shadow_map,
            level: look.level,
            ..sitting::frame(&look.camera, model.subject.origin_m, &self.points_m, size, lit)
        };
        let show = match look.shown {
            Shown::Coat(show) => show,
            Shown::Chart(_) => Show { skin: true, shells: false, fins: false },
            Shown::Channel(_) | Shown::Bald | Shown::Cost => Show::default(),
        };
        let drawn = self.prepared.draw_by(&frame, show, look.blend)?;
        let mut legend = self.legend.clone();
        let counted = if order.count || look.shown == Shown::Cost {
            Some(self.prepared.cost(&frame, show, look.blend)?)
        } else {
            None
        };
        let reads = counted.as_ref().map(|counted| {
            let mut cost = Cost::default();
            cost.add(counted, &drawn.picture);
            cost.per_covered_pixel()[1]
        });
        let mut picture = drawn.picture.clone();
        if let (Shown::Cost, Some(counted)) = (look.shown, &counted) {
            picture = cost::picture(counted);
            legend.push(format!("texels that a pixel reads: none dark blue, {} and more red", cost::MOST_READS));
        }
        if let Shown::Channel(channel) = look.shown {
            let seen = channel::Seen { renderer: self.renderer, scene: self.scene, frame: &frame, blend: look.blend };
            let (measured, told) = channel::draw(channel, &mut self.prepared, &seen, &picture)?;
            picture = measured;
            legend.extend(told);
        }
        if let Some(over_skin) = &mut self.over_skin {
            let hair = over_skin.hair_over_skin(&frame)?;
            picture = bald::picture(&hair, &picture);
            let share = 100.0 * Baldness::of(&hair).share();
            legend.push(format!("{share:.3} % of the furred skin that is seen is bald (red)"));
        }
        let image = look.developed(picture.film());
        let memory = [self.renderer.tile_bytes(), self.prepared.bytes(), drawn.target_bytes];
        let Drawn { passes, level, height_px, shadow, .. } = drawn;
        let statistics = Statistics {
            passes,
            wall_ms: start.elapsed().as_secs_f64() * 1e3,
            memory,
            level,
            height_px: height_px * coarse as f32,
            reads,
            step_texels: self.step_texels,
            no_shadow: shadow == KeyShadow::TooNear,
            legend,
            device: gpu.adapter.to_string(),
        };
        Ok(Answer {
            model: Arc::clone(model),
            look: look.clone(),
            coarseness: coarse,
            picture: Arc::new(picture),
            image,
            statistics,
        })
    }
}
