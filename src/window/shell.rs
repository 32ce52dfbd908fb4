//! The window of the system: events in, pictures of the controls out.

use super::app::{App, Begin, Wish};
use super::painter::Painter;
use super::remember::Settings;
use crate::error::{Error, Kind, Result};
use crate::gpu::Choice;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::{LogicalSize, PhysicalSize};
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Window, WindowId};

/// Something is to be shown anew, after so long.
#[derive(Debug)]
struct Wake(Duration);

/// Opens a window and returns when it is closed.
///
/// # Errors
/// [`Kind::Device`] where there is no display or no adapter, with what to do; and what kept a script from being done.
pub fn open(begin: Begin) -> Result<()> {
    let no_display = |error: &dyn std::fmt::Display| {
        Error::new(Kind::Device, "no window can be opened").with_found(error).with_hint(
            "run it where there is a display (DISPLAY or WAYLAND_DISPLAY is set), or under a virtual one (`xvfb-run furrier view …`)",
        )
    };
    let events = EventLoop::<Wake>::with_user_event().build().map_err(|error| no_display(&error))?;
    events.set_control_flow(ControlFlow::Wait);
    let mut shell = Shell { wake: events.create_proxy(), begin: Some(begin), open: None, outcome: Ok(()), next: None };
    events.run_app(&mut shell).map_err(|error| no_display(&error))?;
    shell.outcome
}

struct Shell {
    wake: EventLoopProxy<Wake>,
    /// Until the window is there.
    begin: Option<Begin>,
    open: Option<Opened>,
    outcome: Result<()>,
    /// When to show the window anew, though nothing happens.
    next: Option<Instant>,
}

/// A window with all that belongs to it.
struct Opened {
    window: Arc<Window>,
    input: egui_winit::State,
    painter: Painter,
    app: App,
    /// Since when something waits to be answered, and when the last picture of the controls was out.
    asked: Option<Instant>,
    painted: Instant,
    /// Where settings are kept; nowhere where a script drives the window.
    settings: Option<PathBuf>,
}

impl Opened {
    fn new(events: &ActiveEventLoop, begin: Begin, wake: EventLoopProxy<Wake>, choice: &Choice) -> Result<Self> {
        // What a script shows does not hang on who ran it.
        let settings = if begin.script.0.is_empty() { Settings::place() } else { None };
        let remembered = settings.as_deref().map(Settings::read).unwrap_or_default();
        let attributes = Window::default_attributes()
            .with_title(format!("furrier: {}", begin.subject.input))
            .with_inner_size(LogicalSize::new(remembered.size[0], remembered.size[1]));
        let window = events
            .create_window(attributes)
            .map_err(|error| Error::new(Kind::Device, "no window can be opened").with_found(error))?;
        let window = Arc::new(window);
        let painter = Painter::new(Arc::clone(&window), choice)?;
        let context = egui::Context::default();
        // The event loop is gone where it hears no more.
        context.set_request_repaint_callback(move |info| drop(wake.send_event(Wake(info.delay))));
        let input = egui_winit::State::new(
            context.clone(),
            egui::ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            window.theme(),
            Some(painter.largest()),
        );
        remembered.apply(&context);
        let mut app = App::new(begin, &context)?;
        app.state.open.panel = remembered.panel;
        window.request_redraw();
        Ok(Self { window, input, painter, app, asked: None, painted: Instant::now(), settings })
    }

    /// Shows the window anew. True where it is to be closed.
    fn show(&mut self) -> Result<bool> {
        let context = self.input.egui_ctx().clone();
        let mut raw = self.input.take_egui_input(&self.window);
        let mut wishes = self.app.play(&mut raw, &context);
        let output = context.run_ui(raw, |ui| wishes.extend(self.app.frame(ui)));
        if let Some(asked) = self.asked.take() {
            // Without what it took to draw the frame before.
            self.app.answers.add(asked.max(self.painted).elapsed());
        }
        self.input.handle_platform_output(&self.window, output.platform_output);
        let jobs = context.tessellate(output.shapes, output.pixels_per_point);
        self.painter.paint(&self.window, &jobs, output.textures_delta, output.pixels_per_point)?;
        let mut close = false;
        for wish in wishes {
            match wish {
                // Where the system does not grant it at once, an event tells when it has.
                Wish::Resize([width, height]) => drop(self.window.request_inner_size(PhysicalSize::new(width, height))),
                Wish::Picture(path) => self.painter.picture(&jobs, output.pixels_per_point, &path)?,
                Wish::Close => close = true,
            }
        }
        self.painted = Instant::now();
        Ok(close)
    }

    /// Something that was to happen at this time is to be answered.
    fn ask(&mut self, at: Instant) {
        self.asked.get_or_insert(at);
        self.window.request_redraw();
    }
}

impl Opened {
    /// Keeps what is to be remembered.
    fn remember(&self) -> Result<()> {
        let Some(path) = &self.settings else { return Ok(()) };
        let size: LogicalSize<f32> = self.window.inner_size().to_logical(self.window.scale_factor());
        let settings = Settings::of(self.input.egui_ctx(), self.app.state.open.panel, [size.width, size.height]);
        settings.write(path)
    }
}

impl Shell {
    fn end(&mut self, events: &ActiveEventLoop, outcome: Result<()>) {
        if self.outcome.is_ok() {
            self.outcome = outcome;
        }
        events.exit();
    }
}

impl ApplicationHandler<Wake> for Shell {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        let Some(begin) = self.begin.take() else { return };
        let choice = begin.device.clone();
        match Opened::new(events, begin, self.wake.clone(), &choice) {
            Ok(opened) => self.open = Some(opened),
            Err(error) => self.end(events, Err(error)),
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        match event {
            WindowEvent::CloseRequested => {
                let outcome = open.remember();
                self.end(events, outcome);
            }
            WindowEvent::RedrawRequested => match open.show() {
                Ok(false) => {}
                Ok(true) => {
                    let outcome = open.app.failure().map_or(Ok(()), Err).and(open.remember());
                    self.end(events, outcome);
                }
                Err(error) => self.end(events, Err(error)),
            },
            event => {
                if open.input.on_window_event(&open.window, &event).repaint {
                    open.ask(Instant::now());
                }
            }
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, Wake(after): Wake) {
        let Some(open) = &mut self.open else { return };
        if after.is_zero() {
            open.ask(Instant::now());
        } else if let Some(at) = Instant::now().checked_add(after) {
            self.next = Some(self.next.map_or(at, |next| next.min(at)));
        }
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { requested_resume, .. }, Some(open)) = (cause, &mut self.open) {
            self.next = None;
            open.ask(requested_resume);
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        events.set_control_flow(self.next.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }
}
