//! Material libraries of Wavefront OBJ (MTL).

use crate::math::{Rgb, Vec2};

/// A material as its library writes it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Material {
    pub(super) name: String,
    /// Line that begins it, from 1.
    pub(super) line: usize,
    /// `Kd`, `Ks`, `Ke`: diffuse and specular reflectance, radiance.
    pub(super) diffuse: Option<Rgb>,
    pub(super) specular: Rgb,
    pub(super) emission: Rgb,
    /// `Ns`: exponent of the highlight.
    pub(super) exponent: f32,
    /// `Ni`: index of refraction.
    pub(super) ior: Option<f32>,
    /// `d`, or one minus `Tr`: opacity.
    pub(super) opacity: f32,
    /// `Tf`: what goes through.
    pub(super) transmission: Rgb,
    /// `illum`: the model of illumination, 0 to 10.
    pub(super) model: i32,
    /// `Pr` and `Pm`, the roughness and the metal of later programs.
    pub(super) roughness: Option<f32>,
    pub(super) metallic: Option<f32>,
    /// `map_Kd`, `map_Ks`, `map_Ke`, `map_d`, `map_bump` (or `bump`), `norm`.
    pub(super) maps: Vec<Map>,
}

/// What a picture gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MapKind {
    Diffuse,
    Specular,
    Emission,
    Opacity,
    Bump,
    Normal,
}

/// A picture with its options.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    pub(super) kind: MapKind,
    pub(super) line: usize,
    pub(super) file: String,
    /// `-o` and `-s`: what coordinates are moved and multiplied by.
    pub(super) offset: Vec2,
    pub(super) scale: Vec2,
    /// `-clamp on`.
    pub(super) clamp: bool,
    /// `-bm`: how high bumps are.
    pub(super) height: f32,
}

/// Something that is not read, or broken: its line, and what is wrong.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Complaint {
    pub(super) line: usize,
    pub(super) message: String,
    pub(super) is_error: bool,
}

/// Statements that say nothing about the picture, or what is drawn in another way.
const IGNORED: [&str; 4] = ["Ka", "map_Ka", "sharpness", "map_aat"];

/// Parses a library.
///
/// Broken statements are complained of, and the rest is read.
pub(super) fn parse(bytes: &[u8]) -> (Vec<Material>, Vec<Complaint>) {
    let text = String::from_utf8_lossy(bytes);
    let (mut materials, mut complaints) = (Vec::<Material>::new(), Vec::new());
    for (index, text) in text.lines().enumerate() {
        let line = index + 1;
        let text = text.split('#').next().unwrap_or_default().trim();
        let (keyword, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        let result = match (keyword, materials.last_mut()) {
            ("", _) => Ok(()),
            ("newmtl", _) => {
                materials.push(Material::new(rest.trim().to_owned(), line));
                Ok(())
            }
            (_, Some(material)) => material.statement(line, keyword, rest.trim()),
            _ => Err((true, format!("\"{keyword}\" before the first newmtl"))),
        };
        if let Err((is_error, message)) = result {
            complaints.push(Complaint {
                line,
                message,
                is_error,
            });
        }
    }
    (materials, complaints)
}

/// What is wrong with a statement, and whether that is an error.
type Problem = (bool, String);

impl Material {
    fn new(name: String, line: usize) -> Self {
        Self {
            name,
            line,
            diffuse: None,
            specular: Rgb::BLACK,
            emission: Rgb::BLACK,
            exponent: 0.0,
            ior: None,
            opacity: 1.0,
            transmission: Rgb::WHITE,
            model: 2,
            roughness: None,
            metallic: None,
            maps: Vec::new(),
        }
    }

    /// The last picture of a kind.
    pub(super) fn map(&self, kind: MapKind) -> Option<&Map> {
        self.maps.iter().rev().find(|map| map.kind == kind)
    }

    fn statement(&mut self, line: usize, keyword: &str, rest: &str) -> Result<(), Problem> {
        match keyword {
            "Kd" => self.diffuse = Some(colour(keyword, rest)?),
            "Ks" => self.specular = colour(keyword, rest)?,
            "Ke" => self.emission = colour(keyword, rest)?,
            "Tf" => self.transmission = colour(keyword, rest)?,
            "Ns" => self.exponent = number(keyword, rest)?.max(0.0),
            "Ni" => self.ior = Some(number(keyword, rest)?),
            "d" => {
                let rest = rest.trim_start_matches("-halo").trim();
                self.opacity = number(keyword, rest)?.clamp(0.0, 1.0);
            }
            "Tr" => self.opacity = 1.0 - number(keyword, rest)?.clamp(0.0, 1.0),
            "Pr" => self.roughness = Some(number(keyword, rest)?.clamp(0.0, 1.0)),
            "Pm" => self.metallic = Some(number(keyword, rest)?.clamp(0.0, 1.0)),
            "illum" => self.model = number(keyword, rest)? as i32,
            _ if IGNORED.contains(&keyword) => {}
            _ => match map_kind(keyword) {
                Some(kind) => self.maps.push(map(line, keyword, kind, rest)?),
                None => return Err((false, format!("\"{keyword}\" is not read; ignored"))),
            },
        }
        Ok(())
    }
}

fn map_kind(keyword: &str) -> Option<MapKind> {
    match keyword.to_lowercase().as_str() {
        "map_kd" => Some(MapKind::Diffuse),
        "map_ks" => Some(MapKind::Specular),
        "map_ke" => Some(MapKind::Emission),
        "map_d" => Some(MapKind::Opacity),
        "map_bump" | "bump" => Some(MapKind::Bump),
        "norm" | "map_kn" => Some(MapKind::Normal),
        _ => None,
    }
}

/// Reads options, then the rest of the line as a name, blanks included.
fn map(line: usize, keyword: &str, kind: MapKind, rest: &str) -> Result<Map, Problem> {
    let mut map = Map {
        kind,
        line,
        file: String::new(),
        offset: Vec2::ZERO,
        scale: Vec2::ONE,
        clamp: false,
        height: 1.0,
    };
    let mut rest = rest;
    while rest.starts_with('-') {
        let (option, after) = word(rest);
        rest = match option {
            "-o" | "-s" | "-t" => {
                let (values, after) = numbers(after);
                let of = |index: usize, default: f32| values.get(index).copied().unwrap_or(default);
                match option {
                    "-o" => map.offset = Vec2::new(of(0, 0.0), of(1, 0.0)),
                    "-s" => map.scale = Vec2::new(of(0, 1.0), of(1, 1.0)),
                    _ => {}
                }
                after
            }
            "-bm" | "-boost" | "-texres" => {
                let (value, after) = word(after);
                if option == "-bm" {
                    map.height = number("-bm", value)?;
                }
                after
            }
            "-mm" => word(word(after).1).1,
            "-clamp" => {
                let (value, after) = word(after);
                map.clamp = value == "on";
                after
            }
            "-blendu" | "-blendv" | "-cc" | "-imfchan" | "-type" => word(after).1,
            _ => return Err((true, format!("{keyword}: unknown option \"{option}\""))),
        };
    }
    if rest.is_empty() {
        return Err((true, format!("{keyword} names no file")));
    }
    rest.clone_into(&mut map.file);
    Ok(map)
}

/// The first word, and what follows it.
fn word(text: &str) -> (&str, &str) {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    (word, rest.trim_start())
}

/// Up to three numbers, and what follows them.
fn numbers(text: &str) -> (Vec<f32>, &str) {
    let (mut values, mut rest) = (Vec::new(), text);
    while values.len() < 3 {
        let (first, after) = word(rest);
        let Ok(value) = first.parse::<f32>() else {
            break;
        };
        values.push(value);
        rest = after;
    }
    (values, rest)
}

fn number(keyword: &str, text: &str) -> Result<f32, Problem> {
    let value = word(text).0.parse::<f32>().ok();
    let value = value.filter(|value| value.is_finite());
    value.ok_or_else(|| (true, format!("{keyword} is \"{text}\", expected a number")))
}

/// One number for grey, or three.
fn colour(keyword: &str, text: &str) -> Result<Rgb, Problem> {
    let (values, rest) = numbers(text);
    let broken = || {
        let message = format!("{keyword} is \"{text}\", expected one number or three");
        Err((true, message))
    };
    let colour = match values[..] {
        [grey] => Rgb::grey(grey),
        [r, g, b] => Rgb::new(r, g, b),
        _ => return broken(),
    };
    if !rest.is_empty() || !colour.0.is_finite() {
        return broken();
    }
    Ok(Rgb(colour.0.max(glam::Vec3::ZERO)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_are_read_with_their_options() {
        let text = "# a library\nnewmtl red wall\nKd 0.5 0.1 0.1\nKs 0.2\nNs 96 # shiny\nNi 1.5\n\
                    d 0.25\nillum 2\nmap_Kd -s 2 3 1 -o 0.5 -clamp on a picture.png\n\
                    map_Bump -bm 0.02 b.png\n\nnewmtl lamp\nKe 5 5 5\nTr 0.25\nPr 0.3\n";
        let (materials, complaints) = parse(text.as_bytes());
        assert_eq!(complaints, []);
        let [red, lamp] = &materials[..] else {
            panic!("{materials:?}");
        };
        assert_eq!((red.name.as_str(), red.line), ("red wall", 2));
        assert_eq!(red.diffuse, Some(Rgb::new(0.5, 0.1, 0.1)));
        assert_eq!((red.specular, red.exponent), (Rgb::grey(0.2), 96.0));
        assert_eq!((red.ior, red.opacity), (Some(1.5), 0.25));
        let map = red.map(MapKind::Diffuse).unwrap();
        assert_eq!((map.file.as_str(), map.clamp), ("a picture.png", true));
        assert_eq!(
            (map.scale, map.offset),
            (Vec2::new(2.0, 3.0), Vec2::new(0.5, 0.0))
        );
        assert_eq!(red.map(MapKind::Bump).unwrap().height, 0.02);
        assert_eq!((lamp.emission, lamp.opacity), (Rgb::grey(5.0), 0.75));
        assert_eq!(lamp.roughness, Some(0.3));
    }

    #[test]
    fn what_is_broken_is_told_with_its_line() {
        let text =
            "Kd 1 1 1\nnewmtl a\nKd 1 2\nNs x\nmap_Kd\nmap_Kd -q 1 a.png\nrefl a.png\nKd 0.5\n";
        let (materials, complaints) = parse(text.as_bytes());
        let said = complaints.iter();
        let said = said.map(|c| format!("{}: {} {}", c.line, c.message, c.is_error));
        let expected = [
            "1: \"Kd\" before the first newmtl true",
            "3: Kd is \"1 2\", expected one number or three true",
            "4: Ns is \"x\", expected a number true",
            "5: map_Kd names no file true",
            "6: map_Kd: unknown option \"-q\" true",
            "7: \"refl\" is not read; ignored false",
        ];
        assert_eq!(said.collect::<Vec<_>>(), expected);
        assert_eq!(materials[0].diffuse, Some(Rgb::grey(0.5)));
    }
}
