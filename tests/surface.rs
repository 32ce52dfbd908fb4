//! A device opened for a window, on an X server of its own that shows nothing to anybody.

use crate::common::skipped;
use furrier::error::{Error, Kind};
use furrier::gpu::{Choice, Gpu};
use std::ffi::CString;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use wgpu::rwh;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt, CreateWindowAux, ImageFormat, WindowClass, WindowWrapper};
use x11rb::xcb_ffi::XCBConnection;

const SIZE: [u16; 2] = [40, 24];

/// An X server without a screen; ends with its owner.
pub struct Server {
    process: Child,
    /// Of the display, as DISPLAY holds it.
    pub name: CString,
}

impl Server {
    /// None, with the reason printed, where there is none to start.
    pub fn start(screen: &str) -> Option<Self> {
        let mut command = Command::new("Xvfb");
        command.args(["-displayfd", "1", "-screen", "0", screen, "-nolisten", "tcp"]);
        let mut process = match command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn() {
            Ok(process) => process,
            Err(error) => {
                skipped(&format!("Xvfb, which windows need, does not start ({error})"));
                return None;
            }
        };
        let mut number = String::new();
        BufReader::new(process.stdout.take().unwrap()).read_line(&mut number).unwrap();
        Some(Self { process, name: CString::new(format!(":{}", number.trim())).unwrap() })
    }

    fn connect(&self) -> XCBConnection {
        XCBConnection::connect(Some(&self.name)).unwrap().0
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.process.kill().unwrap();
        self.process.wait().unwrap();
    }
}

/// A window, and a connection that tells of its display.
struct OnScreen {
    display: XCBConnection,
    window: WindowWrapper<XCBConnection>,
}

impl OnScreen {
    fn new(server: &Server) -> Self {
        let owner = server.connect();
        let screen = &owner.setup().roots[0];
        let (root, visual) = (screen.root, screen.root_visual);
        let id = owner.generate_id().unwrap();
        let ([width, height], depth) = (SIZE, x11rb::COPY_DEPTH_FROM_PARENT);
        let class = WindowClass::INPUT_OUTPUT;
        let made = owner.create_window(depth, id, root, 0, 0, width, height, 0, class, visual, &CreateWindowAux::new());
        made.unwrap().check().unwrap();
        owner.map_window(id).unwrap().check().unwrap();
        Self { display: server.connect(), window: WindowWrapper::for_window(owner, id) }
    }
}

impl rwh::HasDisplayHandle for OnScreen {
    fn display_handle(&self) -> Result<rwh::DisplayHandle<'_>, rwh::HandleError> {
        self.display.display_handle()
    }
}

impl rwh::HasWindowHandle for OnScreen {
    fn window_handle(&self) -> Result<rwh::WindowHandle<'_>, rwh::HandleError> {
        self.window.window_handle()
    }
}

#[test]
fn a_device_opened_for_a_window_draws_into_it() {
    let Some(server) = Server::start("64x64x24") else { return };
    let window = OnScreen::new(&server);
    let id = window.window.window();
    let make = |instance: &wgpu::Instance| {
        instance.create_surface(window).map_err(|e| Error::new(Kind::Device, "no surface").with_found(e))
    };
    let (gpu, screen) = Gpu::open_for_surface(&Choice::Auto, make).unwrap();
    let [width, height] = SIZE.map(u32::from);
    let configuration = wgpu::SurfaceConfiguration { width, height, ..screen.configuration };
    println!("{}, {:?}", gpu.adapter, configuration.format);
    screen.surface.configure(&gpu.device, &configuration);
    let wgpu::CurrentSurfaceTexture::Success(frame) = screen.surface.get_current_texture() else {
        panic!("the window gives no texture")
    };
    let view = frame.texture.create_view(&Default::default());
    let mut encoder = gpu.encoder("clear");
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::RED), store: wgpu::StoreOp::Store },
        })],
        ..Default::default()
    });
    gpu.finish(encoder).unwrap();
    gpu.queue.present(frame);
    // The server shows it when it comes to it. Its pixels are blue, green, red and a byte of nothing.
    let reader = server.connect();
    let shown = || {
        let [width, height] = SIZE;
        let image = reader.get_image(ImageFormat::Z_PIXMAP, id, 0, 0, width, height, u32::MAX).unwrap();
        image.reply().unwrap().data
    };
    let start = Instant::now();
    while shown().chunks_exact(4).any(|pixel| pixel[..3] != [0, 0, 255]) {
        assert!(start.elapsed() < Duration::from_secs(30), "{:?}", &shown()[..16]);
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn what_keeps_a_window_from_opening_is_said() {
    let refused = |_: &wgpu::Instance| Err(Error::usage("there is no window"));
    assert_eq!(Gpu::open_for_surface(&Choice::Auto, refused).err().unwrap().what, "there is no window");
    let Some(server) = Server::start("64x64x24") else { return };
    let window = OnScreen::new(&server);
    let make = |instance: &wgpu::Instance| Ok(instance.create_surface(window).unwrap());
    let error = Gpu::open_for_surface(&"gpu:no such adapter".parse().unwrap(), make).err().unwrap();
    assert_eq!((error.kind, error.parameter), (Kind::Device, Some("device")));
}
