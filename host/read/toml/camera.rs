//! The table `[camera]`.

use glam::{DVec3, Vec3};
use serde::Deserialize;
use toml::Spanned;

use super::reader::Reader;
use super::value::Value;
use super::value::said;
use crate::error::Result;
use crate::scene::surroundings::Lens;
use crate::scene::{View, limits, origin};

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct CameraTable {
    pub(super) eye: Spanned<Value>,
    pub(super) target: Spanned<Value>,
    pub(super) up: Option<Spanned<Value>>,
    pub(super) vertical_fov: Option<Spanned<Value>>,
    pub(super) aperture: Option<Spanned<Value>>,
    pub(super) focus_distance: Option<Spanned<Value>>,
    pub(super) shutter: Option<Spanned<Value>>,
}

impl Reader<'_> {
    pub(super) fn lens(&self, camera: &CameraTable) -> Result<Lens> {
        let mut lens = Lens::default();
        if let Some(aperture) = &camera.aperture {
            lens.aperture = self.number("aperture", aperture, limits::APERTURE)?;
        }
        if let Some(distance) = &camera.focus_distance {
            let distance = self.number("focus_distance", distance, limits::FOCUS_DISTANCE)?;
            lens.focus_distance = Some(distance);
        }
        if let Some(shutter) = &camera.shutter {
            let times: Vec<f32> = match shutter.get_ref() {
                Value::List(times, None) => times.iter().map(|time| *time as f32).collect(),
                _ => Vec::new(),
            };
            match times[..] {
                [open, close]
                    if limits::TIME.holds(open) && limits::TIME.holds(close) && open <= close =>
                {
                    lens.shutter = (open, close);
                }
                _ => {
                    return Err(self
                        .wrong(
                            shutter,
                            "the shutter is not a pair of times",
                            "not possible",
                            "give when it opens and when it closes, the earlier first: [0, 0.5]",
                        )
                        .into());
                }
            }
        }
        Ok(lens)
    }

    /// The point that becomes the origin, if what this camera shows is far from the file's own.
    pub(super) fn origin_near(&self, camera: &CameraTable) -> Option<DVec3> {
        let eye = self.coordinates("eye", &camera.eye).ok()?;
        let target = self.coordinates("target", &camera.target).ok()?;
        origin::near(target, eye.distance(target))
    }

    pub(super) fn view(&self, camera: &Spanned<CameraTable>) -> Result<View> {
        let table = camera.get_ref();
        let view = View {
            eye: self.point("eye", &table.eye)?,
            target: self.point("target", &table.target)?,
            up: match &table.up {
                Some(up) => self.vector("up", up)?,
                None => Vec3::Y,
            },
            vertical_fov: match &table.vertical_fov {
                Some(fov) => match fov.get_ref().number() {
                    Some(degrees) if limits::is_vertical_fov(degrees) => degrees,
                    Some(degrees) => {
                        return Err(self
                            .wrong(
                                fov,
                                format!("vertical_fov = {} is not possible", said(degrees)),
                                "out of range",
                                "give an angle in degrees above 0 and below 180, for example 40",
                            )
                            .into());
                    }
                    None => return Err(self.not_a("vertical_fov", fov, "a number")),
                },
                None => View::DEFAULT_FOV,
            },
        };
        if view.eye == view.target {
            return Err(self
                .wrong(
                    &table.target,
                    "eye and target are the same point",
                    "same as eye",
                    "the camera looks from eye to target: move one of them",
                )
                .into());
        }
        if view.camera(1.0).is_none() {
            let message = "up is zero or points along the view";
            let help = "give an up that points upwards in the image, for example [0, 1, 0]";
            return Err(match &table.up {
                Some(up) => self.wrong(up, message, "no roll angle follows", help),
                None => self.wrong(camera, message, "up is [0, 1, 0] here", help),
            }
            .into());
        }
        Ok(view)
    }
}
