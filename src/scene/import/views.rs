//! Sensors, films, reconstruction filters and samplers.

use super::View;
use super::loader::Loader;
use super::xml::{ElementId, ElementKind, ElementReader, NumberOrName};
use crate::film::{Filter, FilterKind, Window};
use crate::math::Vec2;
use crate::random::SamplerKind;
use crate::sensor::{
    FieldOfViewAxis, Orthographic, Perspective, PerspectiveSettings, Sensor, SensorError,
    Spherical, ThinLens,
};

/// What a film element says.
struct Film {
    size: (u32, u32),
    window: Window,
    filter: Filter,
    alpha: bool,
    half: bool,
}

/// Width and height of a film that says nothing of them.
const DEFAULT_SIZE: (i64, i64) = (768, 576);

/// The largest width and height.
const LARGEST_SIDE: i64 = 65_536;

/// Properties of a film that say how its file is written, which is asked on the command line.
const FILE_OPTIONS: [&str; 13] = [
    "file_format",
    "banner",
    "attach_log",
    "high_quality_edges",
    "gamma",
    "exposure",
    "tonemap_method",
    "label",
    "compensate",
    "sample_border",
    "variable",
    "key",
    "burn",
];

impl Loader<'_> {
    /// Reads a sensor; `None` after noting why there is none.
    ///
    /// - `film_size`: replaces the file's width and height.
    pub(super) fn view(&mut self, id: ElementId, film_size: Option<(u32, u32)>) -> Option<View> {
        let mut reader = self.reader(id);
        let known = ["orthographic", "perspective", "spherical", "thinlens"];
        if !known.contains(&reader.plugin()) {
            self.unknown_plugin(id, known, "a perspective sensor is used instead");
        }
        let film = match reader.child(ElementKind::Film) {
            Some(film) => self.film(film, film_size),
            None => self.default_film(film_size),
        };
        let (sampler, sample_count) = match reader.child(ElementKind::Sampler) {
            Some(sampler) => self.sampler(sampler),
            None => (SamplerKind::Independent, 4),
        };
        self.media_of(&mut reader);
        let sensor = self.sensor(&mut reader, film.as_ref());
        reader.finish();
        let film = film?;
        match sensor {
            Ok(sensor) => Some(View {
                sensor,
                film_size: film.size,
                window: film.window,
                filter: film.filter,
                sampler,
                sample_count,
                alpha: film.alpha,
                half: film.half,
            }),
            Err(error) => {
                self.problems.error(self.location(id), error.to_string());
                None
            }
        }
    }

    fn film(&self, id: ElementId, film_size: Option<(u32, u32)>) -> Option<Film> {
        let mut reader = self.reader(id);
        if !matches!(reader.plugin(), "hdrfilm" | "ldrfilm") {
            let message = format!(
                "unknown {}; \"hdrfilm\" is used instead",
                reader.element().title()
            );
            self.problems.replacement(self.location(id), message);
        }
        let width = reader.integer("width", DEFAULT_SIZE.0);
        let height = reader.integer("height", DEFAULT_SIZE.1);
        let size = film_size.or_else(|| self.film_side(&reader, width, height));
        let window = size.and_then(|size| self.crop(&mut reader, size, film_size.is_some()));
        if let Some(window) = window.filter(|window| !window.is_affordable()) {
            let most = Window::MOST_PIXELS;
            let Window { width, height, .. } = window;
            let message = format!("{width}x{height} pixels are too many, expected {most} at most");
            reader.error("width", message);
        }
        let filter = match reader.child(ElementKind::ReconstructionFilter) {
            Some(filter) => self.filter(filter),
            None => Filter::new(FilterKind::Gaussian { stddev: 0.5 }),
        };
        let alpha = has_alpha(&mut reader);
        let half = reader.string("component_format", "float16").to_lowercase() == "float16";
        reader.ignore(&FILE_OPTIONS);
        reader.finish();
        let (size, window, filter) = (size?, window?, filter?);
        Some(Film {
            size,
            window,
            filter,
            alpha,
            half,
        })
    }

    fn default_film(&self, film_size: Option<(u32, u32)>) -> Option<Film> {
        let size = film_size.unwrap_or((DEFAULT_SIZE.0 as u32, DEFAULT_SIZE.1 as u32));
        let filter = Filter::new(FilterKind::Gaussian { stddev: 0.5 })?;
        let window = Window::full(size.0, size.1);
        Some(Film {
            size,
            window,
            filter,
            alpha: false,
            half: true,
        })
    }

    fn film_side(&self, reader: &ElementReader<'_>, width: i64, height: i64) -> Option<(u32, u32)> {
        let mut sound = true;
        for (name, side) in [("width", width), ("height", height)] {
            if !(1..=LARGEST_SIDE).contains(&side) {
                let message = format!("\"{name}\" is {side}, expected 1 to {LARGEST_SIDE} pixels");
                reader.error(name, message);
                sound = false;
            }
        }
        sound.then_some((width as u32, height as u32))
    }

    /// Reads the crop window; one that does not fit the film is an error.
    ///
    /// - `resized`: the film has another size than the file says, so the file's window means nothing.
    fn crop(
        &self,
        reader: &mut ElementReader<'_>,
        (width, height): (u32, u32),
        resized: bool,
    ) -> Option<Window> {
        let x = reader.optional_integer("crop_offset_x");
        let y = reader.optional_integer("crop_offset_y");
        let crop_width = reader.optional_integer("crop_width");
        let crop_height = reader.optional_integer("crop_height");
        let cropped = x.or(y).or(crop_width).or(crop_height).is_some();
        if resized || !cropped {
            if cropped {
                reader.warning(
                    "crop_width",
                    "the crop window is ignored: the film has another size",
                );
            }
            return Some(Window::full(width, height));
        }
        let (x, y) = (x.unwrap_or(0), y.unwrap_or(0));
        let crop_width = crop_width.unwrap_or(i64::from(width) - x);
        let crop_height = crop_height.unwrap_or(i64::from(height) - y);
        let fits = |start: i64, length: i64, side: u32| {
            start >= 0
                && length > 0
                && start
                    .checked_add(length)
                    .is_some_and(|e| e <= i64::from(side))
        };
        if !(fits(x, crop_width, width) && fits(y, crop_height, height)) {
            let message = format!(
                "the crop window of {crop_width}x{crop_height} pixels at {x},{y} does not fit the \
                 film of {width}x{height}"
            );
            reader.error("crop_width", message);
            return None;
        }
        Some(Window {
            x: x as u32,
            y: y as u32,
            width: crop_width as u32,
            height: crop_height as u32,
        })
    }

    fn filter(&self, id: ElementId) -> Option<Filter> {
        let mut reader = self.reader(id);
        let kind = match reader.plugin() {
            "box" => FilterKind::Box {
                radius: reader.float("radius", 0.5),
            },
            "tent" => FilterKind::Tent {
                radius: reader.float("radius", 1.0),
            },
            "gaussian" => FilterKind::Gaussian {
                stddev: reader.float("stddev", 0.5),
            },
            "mitchell" => FilterKind::Mitchell {
                b: reader.float("b", 1.0 / 3.0),
                c: reader.float("c", 1.0 / 3.0),
            },
            "catmullrom" => FilterKind::CatmullRom,
            "lanczos" => FilterKind::Lanczos {
                lobes: reader.float("lobes", 3.0),
            },
            _ => {
                let title = reader.element().title();
                let message = format!("unknown {title}; \"gaussian\" is used instead");
                self.problems.replacement(self.location(id), message);
                FilterKind::Gaussian { stddev: 0.5 }
            }
        };
        let filter = Filter::new(kind);
        if filter.is_none() {
            let title = reader.element().title();
            self.problems.error(
                self.location(id),
                format!("{title} weighs nothing, or too much"),
            );
        }
        reader.finish();
        filter
    }

    fn sampler(&self, id: ElementId) -> (SamplerKind, u32) {
        let mut reader = self.reader(id);
        let kind = match reader.plugin() {
            "independent" => SamplerKind::Independent,
            "stratified" => SamplerKind::Stratified,
            "sobol" | "ldsampler" => SamplerKind::Sobol,
            _ => {
                let title = reader.element().title();
                let message = format!("unknown {title}; \"sobol\" is used instead");
                self.problems.replacement(self.location(id), message);
                SamplerKind::Sobol
            }
        };
        let count = reader.integer("sample_count", 4);
        if !(1..=i64::from(i32::MAX)).contains(&count) {
            reader.error(
                "sample_count",
                format!("\"sample_count\" is {count}, expected 1 to {}", i32::MAX),
            );
        }
        // Seeds come from the command line; the rest has no counterpart here.
        reader.ignore(&["seed", "dimension", "scramble", "jitter"]);
        reader.finish();
        (kind, count.clamp(1, i64::from(u32::MAX)) as u32)
    }

    fn sensor(
        &self,
        reader: &mut ElementReader<'_>,
        film: Option<&Film>,
    ) -> Result<Sensor, SensorError> {
        if reader.plugin() == "orthographic" {
            reader.ignore(&["shutter_open", "shutter_close"]);
            let to_world = reader.transform("to_world").matrix();
            let near = reader.float("near_clip", 0.01);
            let far = reader.float("far_clip", 1e4);
            let size = film.map_or((1, 1), |film| film.size);
            return Ok(Orthographic::new(to_world, (near, far), size)?.into());
        }
        if reader.plugin() == "spherical" {
            // All is seen, from the camera's own place on.
            reader.ignore(&["near_clip", "far_clip", "shutter_open", "shutter_close"]);
            let to_world = reader.transform("to_world").matrix();
            let size = film.map_or((1, 1), |film| film.size);
            return Ok(Spherical::new(to_world, size)?.into());
        }
        let settings = self.perspective(reader, film);
        if reader.plugin() != "thinlens" {
            // A pinhole has everything in focus.
            reader.ignore(&["focus_distance"]);
            return Ok(Perspective::new(settings)?.into());
        }
        let focus_distance = reader.float("focus_distance", settings.far);
        match reader.required_float("aperture_radius") {
            None => Ok(Perspective::new(settings)?.into()),
            Some(0.0) => {
                reader.warning("aperture_radius", "a lens of radius 0 is a pinhole");
                Ok(Perspective::new(settings)?.into())
            }
            Some(radius) => Ok(ThinLens::new(settings, radius, focus_distance)?.into()),
        }
    }

    fn perspective(
        &self,
        reader: &mut ElementReader<'_>,
        film: Option<&Film>,
    ) -> PerspectiveSettings {
        let (field_of_view, axis) = self.field_of_view(reader);
        let offset_x = reader.float("principal_point_offset_x", 0.0);
        let offset_y = reader.float("principal_point_offset_y", 0.0);
        // Nothing moves.
        reader.ignore(&["shutter_open", "shutter_close"]);
        PerspectiveSettings {
            to_world: reader.transform("to_world").matrix(),
            field_of_view,
            axis,
            near: reader.float("near_clip", 0.01),
            far: reader.float("far_clip", 1e4),
            principal_point_offset: Vec2::new(offset_x, offset_y),
            film_size: film.map_or((1, 1), |film| film.size),
        }
    }

    /// Field of view in degrees, and what it spans.
    pub(super) fn field_of_view(&self, reader: &mut ElementReader<'_>) -> (f32, FieldOfViewAxis) {
        let axes = [
            ("x", FieldOfViewAxis::X),
            ("y", FieldOfViewAxis::Y),
            ("diagonal", FieldOfViewAxis::Diagonal),
            ("smaller", FieldOfViewAxis::Smaller),
            ("larger", FieldOfViewAxis::Larger),
        ];
        let axis = reader.choice("fov_axis", &axes, FieldOfViewAxis::X);
        let field_of_view = reader.optional_float("fov");
        let of_lens = self.focal_length(reader);
        if field_of_view.is_some() && of_lens.is_some() {
            reader.warning("focal_length", "\"fov\" is given, too, and is used instead");
        }
        match field_of_view {
            Some(field_of_view) => (field_of_view, axis),
            None => {
                let default = PerspectiveSettings::field_of_view_of_focal_length(50.0);
                (of_lens.unwrap_or(default), FieldOfViewAxis::Diagonal)
            }
        }
    }

    /// Field of view, from corner to corner, of a lens such as "50mm".
    fn focal_length(&self, reader: &mut ElementReader<'_>) -> Option<f32> {
        let text = match reader.number_or_name("focal_length")? {
            NumberOrName::Number(number) => number.to_string(),
            NumberOrName::Name(text) => text.to_owned(),
        };
        let number = text.trim().trim_end_matches("mm").trim().parse::<f32>();
        match number {
            Ok(length) if length > 0.0 => {
                Some(PerspectiveSettings::field_of_view_of_focal_length(length))
            }
            _ => {
                let message =
                    format!("\"focal_length\" is \"{text}\", expected a length such as \"50mm\"");
                reader.error("focal_length", message);
                None
            }
        }
    }
}

/// Whether a film keeps alpha; an unknown pixel format does not, with a warning.
fn has_alpha(reader: &mut ElementReader<'_>) -> bool {
    let Some(format) = reader.optional_string("pixel_format") else {
        return false;
    };
    match format.to_lowercase().as_str() {
        "rgb" | "luminance" => false,
        "rgba" | "luminance_alpha" => true,
        unknown => {
            let message = format!("unknown pixel format \"{unknown}\"; \"rgb\" is used instead");
            reader.warning("pixel_format", message);
            false
        }
    }
}
