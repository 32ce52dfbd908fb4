use furrier::asset::coat::Fallback;
use furrier::bake::*;
use furrier::preset::Preset;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let r = Request {
        input: a[1].clone(),
        out: a[2].clone().into(),
        preset: Preset::load(&a[3]).unwrap(),
        presets: vec![],
        materials: vec![],
        units: units::Units::Auto,
        method: match a.get(4).map(|s| s.as_str()) {
            Some("uv") => Method::Uv(0),
            Some("atlas") => Method::Atlas,
            _ => Method::Lapped,
        },
        seed: 1,
        fallback: Fallback::Shells(8),
        judge: a.get(5).is_some(),
    };
    let t = std::time::Instant::now();
    match bake(&r, &mut |_| {}) {
        Ok(b) => {
            for n in &b.notes {
                println!("note {n}")
            }
            for x in &b.timings {
                println!("{} {:.0} ms", x.name, x.ms)
            }
            for p in &b.patches {
                println!("{p:?}")
            }
            for rr in &b.accuracy {
                for r in rr {
                    println!("{r:?}")
                }
            }
            println!("total {:.2}", t.elapsed().as_secs_f64());
        }
        Err(e) => println!("{e}\n{:?}", e.hint),
    }
}
