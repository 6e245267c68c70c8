//! What every material must fulfil besides its density: samples agree with `eval`, Diracs with
//! `follow`, no energy is made, and light goes both ways.

use lumiflow::bsdf::{Bsdf, BsdfModel, BsdfSample, Component, DiracEvent, Transport};
use lumiflow::math::statistics::{chi_square_p, sidak, two_sided_p};
use lumiflow::math::{Local, Rgb, Vec2};
use lumiflow::random::{Purpose, Stream};

use crate::support::claims::{Outcome, agree, claim, close};
use crate::support::directions::Cells;
use crate::support::effort::{level, samples, seed};
use crate::support::faulty::{Fault, Faulty};
use crate::support::materials::{
    Case, TRANSPORTS, cases, direction, numbers, spread, surface_point,
};

fn components(bsdf: &dyn BsdfModel) -> impl Iterator<Item = Component> + use<> {
    (0..bsdf.component_count()).map(Component)
}

/// Every Dirac event of one direction.
fn events(bsdf: &dyn BsdfModel, wi: Local, transport: Transport) -> Vec<(Component, DiracEvent)> {
    let at = surface_point();
    components(bsdf)
        .filter_map(|c| Some((c, bsdf.follow(wi, &at, transport, c)?)))
        .collect()
}

/// Runs one check on every example, from every view, for both transports.
fn check_all(base: u64, check: impl Fn(&mut Case) -> Outcome) {
    for mut case in cases(seed(base)) {
        if let Err(text) = check(&mut case) {
            panic!("{}: {text}", case.name);
        }
    }
}

/// A sample reports what `eval`, `density` and `follow` say about its direction.
fn samples_agree(
    bsdf: &dyn BsdfModel,
    wi: Local,
    transport: Transport,
    stream: &mut Stream,
) -> Outcome {
    let at = surface_point();
    for _ in 0..samples(300) {
        let (u_lobe, u) = numbers(stream);
        let Some(sample) = bsdf.sample(wi, &at, transport, u_lobe, u) else {
            continue;
        };
        let wo = sample.direction;
        let (value, density, eta) = if sample.lobe.is_dirac() {
            let event = bsdf
                .follow(wi, &at, transport, sample.component)
                .ok_or("a sampled Dirac cannot be followed")?;
            claim(event.lobe == sample.lobe, || "lobes differ".into())?;
            let way = event.direction.0.distance(wo.0);
            claim(way < 1e-6, || format!("directions {way} apart"))?;
            (event.coefficient, event.probability, event.eta)
        } else {
            let value = bsdf.eval(wi, wo, &at, transport);
            let density = bsdf.density(wi, wo, &at, transport);
            let both = bsdf.eval_with_density(wi, wo, &at, transport);
            claim(close(both.0, value, 1e-5), || "values differ".into())?;
            let difference = (both.1.0 - density.0).abs();
            claim(difference <= 1e-5 * density.0, || "densities differ".into())?;
            (value, density.0, sample.eta)
        };
        claim(agree(&sample, value), || {
            format!("value {:?}, not {value:?}, to {wo:?}", sample.value)
        })?;
        claim((sample.density - density).abs() <= 1e-4 * density, || {
            format!("density {}, not {density}", sample.density)
        })?;
        claim(
            close(sample.weight, sample.value / sample.density, 1e-4),
            || format!("{sample:?}: weight is not value over density"),
        )?;
        claim(sample.eta == eta, || "eta differs".into())?;
        let refracted = !wi.same_side(wo) || sample.eta == 1.0;
        claim(wo.0.is_normalized() && refracted, || format!("{sample:?}"))?;
    }
    Ok(())
}

/// Chance that Dirac components are selected as often as `follow` says.
fn selection_p(
    bsdf: &dyn BsdfModel,
    wi: Local,
    transport: Transport,
    stream: &mut Stream,
) -> Option<f64> {
    let count = samples(20_000);
    let at = surface_point();
    // The last place counts finite lobes and directions without a sample.
    let others = usize::from(bsdf.component_count());
    let mut observed = vec![0.0; others + 1];
    for _ in 0..count {
        let (u_lobe, u) = numbers(stream);
        let dirac = bsdf
            .sample(wi, &at, transport, u_lobe, u)
            .filter(|sample| sample.lobe.is_dirac());
        observed[dirac.map_or(others, |sample| usize::from(sample.component.0))] += 1.0;
    }
    let mut expected = vec![0.0; others + 1];
    for (component, event) in events(bsdf, wi, transport) {
        expected[usize::from(component.0)] = f64::from(count) * f64::from(event.probability);
    }
    let rest = f64::from(count) - expected.iter().sum::<f64>();
    expected[others] = if rest < 1e-2 { 0.0 } else { rest };
    let certain = expected.iter().filter(|e| **e > 0.0).count() < 2;
    match chi_square_p(&observed, &expected) {
        // One outcome only: it is that one or it is wrong.
        None | Some(0.0) if certain => Some(f64::from(observed == expected)),
        p => p,
    }
}

/// What of light is summed up.
#[derive(Clone, Copy)]
enum Quantity {
    /// What a path carries.
    Carried(Transport),
    /// Radiance without its concentration in denser substances.
    Power,
}

/// Directions that show the quadrature where a material scatters.
const PILOT: u32 = 2000;

/// Share of light from `wi` that leaves in some channels: by quadrature of `eval`, plus the Dirac
/// coefficients.
fn scattered<const N: usize>(
    bsdf: &dyn BsdfModel,
    wi: Local,
    quantity: Quantity,
    channels: [usize; N],
    stream: &mut Stream,
) -> [f64; N] {
    let at = surface_point();
    let (transport, is_power) = match quantity {
        Quantity::Carried(transport) => (transport, false),
        Quantity::Power => (Transport::Radiance, true),
    };
    let share = |eta: f32| if is_power { 1.0 / (eta * eta) } else { 1.0 };
    let dirac: Rgb = events(bsdf, wi, transport)
        .iter()
        .map(|(_, event)| event.coefficient * share(event.eta))
        .sum();
    if !bsdf.lobes().finite {
        return channels.map(|channel| f64::from(dirac[channel]));
    }
    let (shift, shift_lobe) = (stream.next_f32(), stream.next_f32());
    let pilot: Vec<BsdfSample> = (0..PILOT)
        .filter_map(|i| {
            // Evenly spread along each axis: no tail of a lobe may go without a direction.
            let place = (i as f32 + stream.next_f32()) / PILOT as f32;
            let golden = |ratio: f32, shift: f32| (i as f32 * ratio + shift).fract();
            let u = Vec2::new(place.min(1.0 - f32::EPSILON), golden(0.618_034, shift));
            let u_lobe = golden(0.754_877_7, shift_lobe);
            let sample = bsdf.sample(wi, &at, transport, u_lobe, u)?;
            (!sample.lobe.is_dirac()).then_some(sample)
        })
        .collect();
    let through = pilot.iter().find(|s| !wi.same_side(s.direction));
    let behind = through.map_or(1.0, |sample| share(sample.eta));
    let cells = Cells::around(pilot.iter().map(|sample| sample.direction));
    channels.map(|channel| {
        let value = |wo: Local| {
            let share = if wi.same_side(wo) { 1.0 } else { behind };
            f64::from(bsdf.eval(wi, wo, &at, transport)[channel] * share)
        };
        cells.integral(value) + f64::from(dirac[channel])
    })
}

/// No channel sends out more power than it gets.
///
/// Importance is no measure of it: at a bump, as at any shading normal, it can grow.
fn no_energy_is_made(bsdf: &dyn BsdfModel, wi: Local, stream: &mut Stream) -> Outcome {
    let scattered = scattered(bsdf, wi, Quantity::Power, [0, 1, 2], stream);
    claim(scattered.iter().all(|s| *s <= 1.0 + 1e-3), || {
        format!("scatters {scattered:?}")
    })
}

/// Chance that the mean weight of samples is what `eval` and `follow` say.
pub(crate) fn mean_weight_p(
    bsdf: &dyn BsdfModel,
    wi: Local,
    transport: Transport,
    stream: &mut Stream,
) -> f64 {
    /// Relative error of the quadrature.
    const QUADRATURE: f64 = 2e-4;
    let count = samples(10_000);
    let at = surface_point();
    let [exact] = scattered(bsdf, wi, Quantity::Carried(transport), [0], stream);
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..count {
        let (u_lobe, u) = numbers(stream);
        let sample = bsdf.sample(wi, &at, transport, u_lobe, u);
        let weight = sample.map_or(0.0, |sample| f64::from(sample.weight.r()));
        sum += weight;
        squares += weight * weight;
    }
    let count = f64::from(count);
    let mean = sum / count;
    let variance = (squares / count - mean * mean).max(0.0) / count;
    let deviation = (variance + (QUADRATURE * exact).powi(2) + 1e-12).sqrt();
    two_sided_p((mean - exact) / deviation)
}

/// Importance from `wi` to `wo` is scattered as radiance from `wo` to `wi`, and so the other way round.
///
/// `f*(wi → wo) = f(wo → wi)`. A Dirac's `f` is its coefficient over `|cos θ_o|`, and turning the
/// δ of `wi` into one of `wo` takes the ratio of their cones. Where the shading normal is that of the
/// material this leaves coefficients apart by the ratio of the projected solid angles,
/// `(η_i / η_o)²`; at a bump their cosines differ as well.
///
/// Source: Veach 1997, Ch. 3 and 5.
pub(crate) fn light_goes_both_ways(
    bsdf: &dyn BsdfModel,
    wi: Local,
    transport: Transport,
    stream: &mut Stream,
) -> Outcome {
    const TOLERANCE: f32 = 3e-3;
    let at = surface_point();
    for _ in 0..samples(100) {
        let (u_lobe, u) = numbers(stream);
        let Some(sample) = bsdf.sample(wi, &at, transport, u_lobe, u) else {
            continue;
        };
        let wo = sample.direction;
        // In the plane of the surface there is nothing left to compare.
        if wo.abs_cos() < 1e-3 {
            continue;
        }
        let (there, back) = if sample.lobe.is_dirac() {
            let back = bsdf
                .follow(wo, &at, transport.adjoint(), sample.component)
                .ok_or("a Dirac has no way back")?;
            let apart = back.direction.0.distance(wi.0);
            claim(apart < 1e-3, || format!("the way back is {apart} off"))?;
            let Some(spread) = spread(bsdf, wi, transport, sample.component) else {
                continue;
            };
            let there = sample.value / wo.abs_cos();
            (there, back.coefficient * (spread / wi.abs_cos()))
        } else {
            let there = bsdf.eval(wi, wo, &at, transport) / wo.abs_cos();
            let back = bsdf.eval(wo, wi, &at, transport.adjoint()) / wi.abs_cos();
            (there, back)
        };
        claim(close(there, back, TOLERANCE), || {
            format!("{there:?} to {wo:?}, {back:?} back")
        })?;
    }
    Ok(())
}

#[test]
fn samples_agree_with_eval_density_and_follow() {
    check_all(21, |case| {
        samples_agree(&case.bsdf, case.wi, case.transport, &mut case.stream)
    });
}

#[test]
fn diracs_are_selected_with_their_probabilities() {
    let cases: Vec<Case> = cases(seed(22))
        .into_iter()
        .filter(|case| case.bsdf.lobes().dirac)
        .collect();
    let level = sidak(level(0.01), cases.len());
    for mut case in cases {
        let p = selection_p(&case.bsdf, case.wi, case.transport, &mut case.stream);
        assert!(p.unwrap_or(1.0) > level, "{}: p = {p:?}", case.name);
    }
}

#[test]
fn no_material_makes_energy() {
    check_all(23, |case| match case.transport {
        Transport::Radiance => no_energy_is_made(&case.bsdf, case.wi, &mut case.stream),
        Transport::Importance => Ok(()),
    });
}

#[test]
fn mean_weights_are_the_integral_of_eval() {
    let cases = cases(seed(24));
    let level = sidak(level(0.01), cases.len());
    for mut case in cases {
        let p = mean_weight_p(&case.bsdf, case.wi, case.transport, &mut case.stream);
        assert!(p > level, "{}: p = {p:.2e}", case.name);
    }
}

#[test]
fn radiance_and_importance_are_adjoint() {
    check_all(25, |case| {
        light_goes_both_ways(&case.bsdf, case.wi, case.transport, &mut case.stream)
    });
}

#[test]
fn nothing_breaks_at_the_edges() {
    let at = surface_point();
    let largest = 1.0 - f32::EPSILON / 2.0;
    let mut views = vec![Local::new(1.0, 0.0, 0.0), Local::new(0.0, -1.0, -0.0)];
    for cos in [1e-3_f32, 1e-6, 1e-12, 1e-30] {
        views.push(Local::new((1.0 - cos * cos).sqrt(), 0.0, cos));
        views.push(Local::new(0.0, (1.0 - cos * cos).sqrt(), -cos));
    }
    views.extend([Local::NORMAL, Local::NORMAL.flipped(), direction(60.0, 0.0)]);
    for bsdf in Bsdf::examples() {
        // Where a bump leans to a slanted light, importance grows without bound; radiance does not.
        let text = format!("{bsdf:?}");
        let leans = text.contains("BumpMap") || text.contains("NormalMap");
        for (wi, transport) in views.iter().flat_map(|wi| TRANSPORTS.map(|t| (*wi, t))) {
            for wo in &views {
                let (value, density) = bsdf.eval_with_density(wi, *wo, &at, transport);
                assert!(
                    value.is_finite() && value.0.min_element() >= 0.0 && density.0 >= 0.0,
                    "{bsdf:?} {wi:?} {wo:?}: {value:?} {density:?}"
                );
            }
            for (u_lobe, u_x, u_y) in [0.0, 0.5, largest]
                .into_iter()
                .flat_map(|a| [0.0, 0.5, largest].map(|b| (a, b)))
                .flat_map(|(a, b)| [0.0, 0.5, largest].map(|c| (a, b, c)))
            {
                let u = Vec2::new(u_x, u_y);
                if let Some(sample) = bsdf.sample(wi, &at, transport, u_lobe, u) {
                    let weight = sample.weight;
                    assert!(
                        weight.is_finite() && sample.density > 0.0,
                        "{} {wi:?} {u_lobe} {u}: {sample:?}",
                        bsdf.name()
                    );
                    let may_grow = leans && transport == Transport::Importance;
                    assert!(
                        may_grow || weight.max_channel() < 20.0,
                        "{} {wi:?} {u_lobe} {u}: {sample:?}",
                        bsdf.name()
                    );
                }
            }
        }
    }
}

#[test]
fn planted_errors_are_found() {
    let mut stream = Stream::new(seed(26), Purpose::Check, 0, 0);
    let stream = &mut stream;
    let example = |name: &str| {
        let all = Bsdf::examples();
        let found = all.into_iter().find(|bsdf| bsdf.name() == name);
        found.unwrap_or_else(|| panic!("no example of {name}"))
    };
    let faulty = |name: &str, fault| Faulty {
        bsdf: example(name),
        fault,
    };
    let wi = direction(50.0, 70.0);
    let (radiance, importance) = (Transport::Radiance, Transport::Importance);
    for name in ["Diffuse", "TwoSided", "RoughDielectric", "RoughPlastic"] {
        for fault in [Fault::Density, Fault::Cosine] {
            assert!(samples_agree(&faulty(name, fault), wi, importance, stream).is_err());
        }
        let energy = faulty(name, Fault::Energy);
        assert!(no_energy_is_made(&energy, wi, stream).is_err());
        assert!(mean_weight_p(&faulty(name, Fault::Weight), wi, radiance, stream) < 1e-3);
        let cosine = faulty(name, Fault::Cosine);
        assert!(light_goes_both_ways(&cosine, wi, importance, stream).is_err());
    }
    for name in ["Dielectric", "Plastic", "Coating"] {
        let selection = faulty(name, Fault::Selection);
        assert!(samples_agree(&selection, wi, radiance, stream).is_err());
        let p = selection_p(&selection, wi, radiance, stream);
        assert!(p.is_some_and(|p| p < 1e-3), "{p:?}");
    }
    for name in ["Dielectric", "RoughDielectric", "BumpMap", "NormalMap"] {
        let one_transport = faulty(name, Fault::EtaSquared);
        assert!(light_goes_both_ways(&one_transport, wi, importance, stream).is_err());
    }
}
