//! What the images of a scene are measured against.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use crate::cli::args::{BenchArgs, Crop};
use crate::cli::failure::{Failure, sizes_differ};
use crate::cli::outputs::scene_name;
use crate::cli::pictures::{cropped, pixels, variance};
use crate::image::{AttributeValue, read_exr};
use crate::math::Rgb;
use crate::output::FileKind;
use crate::report::{Errors, Pixels, Subject};

/// Names of the files that are looked for beside a scene.
const REFERENCE: &str = "reference.exr";
const REFERENCE_VARIANCE: &str = "reference_var.exr";
const MASK: &str = "emitter_mask.png";

/// Says that all pixels count, in place of a mask.
const NO_MASK: &str = "none";

/// A scene, and the files that its images are measured against.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Course {
    pub(super) scene: PathBuf,
    pub(super) name: String,
    pub(super) reference: PathBuf,
    pub(super) variance: Option<PathBuf>,
    pub(super) mask: Option<PathBuf>,
}

impl Course {
    /// Finds the files of a scene.
    ///
    /// # Errors
    /// [`Failure::File`] where there is no reference.
    pub(super) fn find(scene: &Path, args: &BenchArgs) -> Result<Self, Failure> {
        let folder = scene.parent().filter(|folder| *folder != OsStr::new(""));
        let folder = folder.unwrap_or(Path::new("."));
        let name = scene_name(scene);
        let given = |text: &Option<String>| {
            let text = text.as_ref()?.replace("{dir}", &folder.to_string_lossy());
            Some(PathBuf::from(text.replace("{name}", &name)))
        };
        let beside = |file: &str| Some(folder.join(file)).filter(|path| path.is_file());
        let (reference, usual_variance) = match given(&args.reference) {
            Some(reference) => (reference, None),
            None => (folder.join(REFERENCE), beside(REFERENCE_VARIANCE)),
        };
        if !reference.is_file() {
            let hint = match args.reference {
                Some(_) => "",
                None => "; name another file with --reference",
            };
            let (scene, reference) = (scene.display(), reference.display());
            return Err(Failure::File(format!(
                "no reference for {scene}: there is no file {reference}{hint}"
            )));
        }
        let mask = match args.mask.as_deref() {
            Some(NO_MASK) => None,
            _ => given(&args.mask).or_else(|| beside(MASK)),
        };
        Ok(Self {
            scene: scene.to_owned(),
            variance: given(&args.reference_variance).or(usual_variance),
            reference,
            mask,
            name,
        })
    }
}

/// The pictures of a [`Course`], cut alike.
pub(super) struct Yardstick {
    crop: Option<Crop>,
    exposure: f32,
    /// What images should be, uncut.
    pub(super) whole: Pixels,
    reference: Pixels,
    variance: Option<Pixels>,
    counted: Vec<bool>,
    /// The seed that the reference was rendered with, if that was done by lumiflow.
    pub(super) reference_seed: Option<u64>,
}

impl Yardstick {
    /// Reads the pictures.
    ///
    /// - `size`: of the images that will be measured.
    ///
    /// # Errors
    /// Files that cannot be read, pictures of other sizes, and no pixel left that counts.
    pub(super) fn read(
        course: &Course,
        args: &BenchArgs,
        size: (u32, u32),
    ) -> Result<Self, Failure> {
        let fit = |path: &Path, image: Pixels| {
            let own = (image.width, image.height);
            if own != size {
                return Err(sizes_differ(&course.scene, size, path, own));
            }
            Ok(image)
        };
        let cut = |image| cropped(image, args.crop);
        let whole = fit(&course.reference, pixels(&course.reference)?)?;
        let reference = cut(whole.clone())?;
        let read_variance = |path: &PathBuf| fit(path, variance(path)?).and_then(cut);
        let read_mask = |path: &PathBuf| fit(path, pixels(path)?);
        let mask = course.mask.as_ref().map(read_mask).transpose()?;
        let mask = mask.unwrap_or_else(|| Pixels {
            width: size.0,
            height: size.1,
            colours: vec![Rgb::BLACK; size.0 as usize * size.1 as usize],
        });
        let mask = cut(without_rows(mask, args.skip_rows))?;
        let counted: Vec<bool> = mask.colours.iter().map(|c| c.is_black()).collect();
        if !counted.contains(&true) {
            let scene = course.scene.display();
            return Err(Failure::Usage(format!(
                "{scene}: the mask and --skip-rows leave no pixel to compare"
            )));
        }
        Ok(Self {
            crop: args.crop,
            exposure: args.exposure,
            whole,
            reference,
            variance: course.variance.as_ref().map(read_variance).transpose()?,
            counted,
            reference_seed: seed_of(&course.reference),
        })
    }

    /// Number of pixels that count.
    pub(super) fn pixels(&self) -> usize {
        self.counted.iter().filter(|counts| **counts).count()
    }

    /// How far an image is from the reference, and in how many of the pixels that count it is not
    /// finite.
    pub(super) fn measure(&self, image: Pixels) -> Result<(Errors, usize), Failure> {
        let image = cropped(image, self.crop)?;
        let subject = Subject {
            image: &image,
            reference: &self.reference,
            variance: None,
            reference_variance: self.variance.as_ref(),
            counted: &self.counted,
        };
        let errors = Errors::of(&subject, self.exposure);
        Ok((errors, subject.not_finite(&image)))
    }
}

/// Makes the first and the last rows of a mask white.
fn without_rows(mut mask: Pixels, rows: u32) -> Pixels {
    let count = mask.colours.len();
    let left_out = (rows as usize)
        .saturating_mul(mask.width as usize)
        .min(count);
    mask.colours[..left_out].fill(Rgb::WHITE);
    mask.colours[count - left_out..].fill(Rgb::WHITE);
    mask
}

/// The seed that is noted in a file of ours.
fn seed_of(reference: &Path) -> Option<u64> {
    let is_exr = FileKind::of(reference) == Some(FileKind::Exr);
    let image = is_exr.then(|| read_exr(reference).ok()).flatten()?;
    match image.metadata.get("lumiflow.seed")? {
        AttributeValue::String(seed) => seed.parse().ok(),
        _ => None,
    }
}
