//! What the rounds say.

use std::path::Path;

use lumiflow::accel;

use crate::recorded::Recorded;
use crate::rounds::Round;

/// What is measured, and with what.
pub(crate) fn head(rounds: usize) {
    let (headers, library) = accel::versions().expect("Embree starts");
    println!("Embree {library} (headers {headers}), one thread, {rounds} rounds in turn\n");
    println!(
        "Medians, and lowest … highest of the rounds. Ratios are throughputs over that of raw Embree."
    );
    println!("as asked: in the calls of the render itself, many rays at once in `path`\n");
    println!(
        "| scene | integrator | rays an item: closest, occlusion | raw ns: closest, occlusion | \
         hit / raw | surface / raw | occlusion / raw | raw packets / raw: closest | occlusion | \
         surface as asked / raw | occlusion as asked / raw | M items a CPU s | bound | share of the bound |"
    );
    println!("|{}", "---|".repeat(14));
}

/// One scene and integrator.
pub(crate) fn row(file: &Path, recorded: &Recorded, rounds: &[Round]) {
    let folder = file.parent().and_then(Path::file_name);
    let scene = folder.map_or_else(
        || file.display().to_string(),
        |f| f.to_string_lossy().into(),
    );
    let items = recorded.items as f64;
    let bound = |r: &Round| items / r.least_raw() / 1e6;
    let rate = |r: &Round| items / r.render / 1e6;
    let each = |measure: &dyn Fn(&Round) -> f64| Spread::new(rounds.iter().map(measure)).show();
    // Of chains, which ask about one ray at a time, the way through the calls would tell nothing else.
    let is_together = recorded.packets.is_some();
    let as_asked = |measure: &dyn Fn(&Round) -> f64| {
        if is_together {
            each(measure)
        } else {
            "–".to_owned()
        }
    };
    let packets = |r: &Round| r.raw_packets.unwrap_or_default();
    let per_ray = |seconds: &dyn Fn(&Round) -> f64, rays: usize| {
        let spread = Spread::new(rounds.iter().map(|r| seconds(r) / rays as f64 * 1e9));
        format!("{:.1}", spread.median)
    };
    let (closest, occlusion) = (&recorded.closest, &recorded.occlusion);
    let cells = [
        scene,
        recorded.name.to_owned(),
        format!(
            "{:.2}, {:.2}",
            recorded.per_item(closest),
            recorded.per_item(occlusion)
        ),
        format!(
            "{}, {}",
            per_ray(&|r| r.raw_closest, closest.as_slice().len()),
            per_ray(&|r| r.raw_occlusion, occlusion.as_slice().len())
        ),
        each(&|r| r.raw_closest / r.hit),
        each(&|r| r.raw_closest / r.surface),
        each(&|r| r.raw_occlusion / r.occlusion),
        as_asked(&|r| r.raw_closest / packets(r)[0]),
        as_asked(&|r| r.raw_occlusion / packets(r)[1]),
        as_asked(&|r| r.raw_closest / r.surface_as_asked),
        as_asked(&|r| r.raw_occlusion / r.occlusion_as_asked),
        each(&rate),
        each(&bound),
        each(&|r| rate(r) / bound(r)),
    ];
    println!("| {} |", cells.join(" | "));
}

/// What the columns are.
pub(crate) fn foot() {
    println!(
        "\nAn item is a path, of `erpt` a mutation with its part of the seeds. The bound is the rate if \
         nothing but the raw calls took time, those in packets where these take less."
    );
}

/// The middle of several values, and how far they go.
struct Spread {
    lowest: f64,
    median: f64,
    highest: f64,
}

impl Spread {
    fn new(values: impl Iterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.collect();
        values.sort_by(f64::total_cmp);
        let middle = values.len() / 2;
        let median = if values.len() % 2 == 1 {
            values[middle]
        } else {
            0.5 * (values[middle - 1] + values[middle])
        };
        Self {
            lowest: values[0],
            median,
            highest: values[values.len() - 1],
        }
    }

    fn show(&self) -> String {
        format!(
            "{:.2} ({:.2} … {:.2})",
            self.median, self.lowest, self.highest
        )
    }
}
