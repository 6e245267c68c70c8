use lumiflow::{
    accel::*, bsdf::*, film::*, integrator::*, math::*, random::*, scene::*, sensor::*, shape::*,
};
use std::sync::atomic::*;
fn main() {
    let dir = "/work/shared/reference/cornell-box/";
    let mut b = SceneBuilder::new();
    let mut mats = std::collections::HashMap::new();
    for (n, c) in [
        ("white", [0.725, 0.71, 0.68]),
        ("red", [0.63, 0.065, 0.05]),
        ("green", [0.14, 0.45, 0.091]),
        ("black", [0.78f32; 3]),
    ] {
        mats.insert(n, b.add_bsdf(Diffuse::new(Rgb::from(c))));
    }
    for (f, m) in [
        ("floor", "white"),
        ("ceiling", "white"),
        ("back", "white"),
        ("short", "white"),
        ("tall", "white"),
        ("left", "red"),
        ("right", "green"),
        ("light", "black"),
    ] {
        let (ms, _) = tobj::load_obj(format!("{dir}{f}.obj"), &tobj::GPU_LOAD_OPTIONS).unwrap();
        for mesh in ms {
            let p: Vec<[f32; 3]> = mesh
                .mesh
                .positions
                .chunks(3)
                .map(|c| [c[0], c[1], c[2]])
                .collect();
            let i: Vec<[u32; 3]> = mesh
                .mesh
                .indices
                .chunks(3)
                .map(|c| [c[0], c[1], c[2]])
                .collect();
            let shape = TriangleMesh::new(VertexBuffer::new(p), IndexBuffer::new(i), None, None);
            b.add_shape(
                shape,
                mats[m],
                (f == "light").then(|| Rgb::new(17.0, 12.0, 4.0).into()),
            )
            .unwrap();
        }
    }
    let scene = b.build().unwrap();
    let sensor = Sensor {
        origin: Vec3::new(278.0, 273.0, -800.0),
        scale: (39.3077f32 / 2.0).to_radians().tan(),
        size: 256.0,
    };
    let options = Options::new();
    let integrator = from_options("path", &mut OptionReader::new(&options)).unwrap();
    let settings = PixelSettings {
        seed: 0,
        window: Window::full(256, 256),
        filter: Filter::pixel_box(),
        sampler: SamplerKind::Independent,
        alpha: false,
        second_moment: false,
        aovs: vec![],
    };
    let spp: u32 = std::env::args().nth(1).map_or(32, |s| s.parse().unwrap());
    let threads: usize = std::env::args().nth(2).map_or(1, |s| s.parse().unwrap());
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .start_handler(|_| prepare_worker())
        .build()
        .unwrap();
    let r = PixelRender::new(&scene, &sensor, &*integrator, settings);
    let t = std::time::Instant::now();
    let out = pool.install(|| {
        render(
            &r,
            |_| false,
            &AtomicBool::new(false),
            &AtomicU64::new(0),
            |s| {
                if s.passes < spp {
                    std::ops::ControlFlow::Continue(())
                } else {
                    std::ops::ControlFlow::Break(())
                }
            },
        )
    });
    let s = t.elapsed().as_secs_f64();
    println!(
        "{:.3} s  {:.3} Mpaths/s  {:.2} Mrays/s  {:.2} rays/path",
        s,
        out.counters.paths as f64 / s / 1e6,
        out.counters.rays as f64 / s / 1e6,
        out.counters.rays as f64 / out.counters.paths as f64
    );
    let m = out.layers[0].1.mean();
    println!(
        "mean {}",
        m.iter().map(|v| *v as f64).sum::<f64>() / m.len() as f64
    );
}
