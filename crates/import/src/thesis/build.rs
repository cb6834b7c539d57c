//! From directives to a scene.

use super::assets::{Assets, MeshUse};
use super::camera::{self, CAMERA_EXAMPLE};
use super::comment;
use super::draft::{Draft, MaterialOrigin};
use super::field::{Directive, Reader};
use super::scan::{Item, Scanner, SyntaxError};
use super::{light, material, mesh, primitive, spans};
use crate::resolver::Resolver;
use crate::source::Source;
use crate::{Fault, ImportError, Imported, Limits};
use lightcuts_scene::{
    Issue, Location, MaterialDesc, MaterialId, ObjectDesc, SceneDesc, ShapeDesc, Subject, TextureDesc,
};
use std::ops::Range;
use std::path::Path;

/// Bytes of a comment that are looked at for parameters.
const MAX_COMMENT: usize = 1024;

/// Reads a whole scene text.
pub(super) struct Builder<'t> {
    source: &'t Source<'t>,
    limits: &'t Limits,
    assets: Assets<'t>,
    draft: Draft,
    /// Starts of the last `S` and `C` directives.
    background: Option<usize>,
    camera: Option<usize>,
    /// Directives so far, of any kind.
    directives: usize,
}

impl<'t> Builder<'t> {
    pub(super) fn new(source: &'t Source<'t>, name: &str, resolver: &'t dyn Resolver, limits: &'t Limits) -> Self {
        let stem = Path::new(name).file_stem().unwrap_or_default();
        let scene = SceneDesc { name: stem.to_string_lossy().into_owned(), ..SceneDesc::default() };
        Self {
            source,
            limits,
            assets: Assets::new(resolver, limits),
            draft: Draft { scene, ..Draft::default() },
            background: None,
            camera: None,
            directives: 0,
        }
    }

    pub(super) fn run(mut self) -> Result<Imported, ImportError> {
        let mut scanner = Scanner::new(self.source.text(), 0);
        while !self.draft.report.is_full() {
            let item = scanner.next_item();
            for comment in scanner.comments.drain(..) {
                self.comment(comment);
            }
            let Some(item) = item else { break };
            self.item(item);
            if self.directives > self.limits.directives {
                self.error(
                    scanner.place(),
                    &format!("more than {} directives", self.limits.directives),
                    "a smaller scene",
                );
                break;
            }
        }
        if !self.draft.report.is_full() {
            self.check_completeness();
            for issue in self.draft.scene.validate() {
                self.issue(&issue);
            }
        }
        let warnings = self.draft.report.finish()?;
        Ok(Imported { scene: self.draft.scene, warnings, files: self.assets.files.opened })
    }

    fn error(&mut self, span: Range<usize>, message: &str, expected: &str) {
        self.draft.report.error(|| self.source.fault(span, message).expected(expected));
    }

    fn warn(&mut self, span: Range<usize>, message: &str) {
        self.draft.report.warn(|| self.source.fault(span, message));
    }

    fn item(&mut self, item: Item<'t>) {
        match item {
            Item::Directive(directive) => {
                self.directives += 1;
                // Cleared by an error, so that one mistake gives one message.
                if self.directive(&directive).is_some() {
                    self.reader(&directive).warn_unused();
                }
            }
            Item::Broken(letter, SyntaxError { span, message, expected }) => {
                self.directives += 1;
                if letter == 'C' {
                    self.camera = self.camera.or(Some(span.start));
                }
                self.error(span, &message, &expected);
            }
            Item::Unknown(span) => {
                self.warn(span, "unknown directive; a line starts with #, S, C, L, P or O and a blank or `|`");
            }
        }
    }

    fn reader<'a>(&'a mut self, directive: &'a Directive<'t>) -> Reader<'a, 't> {
        Reader { directive, source: self.source, report: &mut self.draft.report }
    }

    /// `None` if an error was reported.
    fn directive(&mut self, directive: &Directive<'t>) -> Option<()> {
        match directive.letter {
            'S' => {
                self.note_repetition(directive, self.background, "scene");
                self.background = Some(directive.span.start);
                self.draft.scene.background = camera::background(&mut self.reader(directive))?;
            }
            'C' => {
                self.note_repetition(directive, self.camera, "camera");
                self.camera = Some(directive.span.start);
                self.draft.scene.camera = camera::camera(&mut self.reader(directive))?;
            }
            'L' => {
                let location = self.location(directive);
                let light = light::light(&mut self.reader(directive), location)?;
                self.draft.scene.lights.push(light);
                self.draft.lights.push(directive.span.start);
            }
            'P' => self.primitive(directive)?,
            _ => self.mesh(directive)?,
        }
        Some(())
    }

    fn location(&self, directive: &Directive<'_>) -> Location {
        self.source.locate(directive.span.start)
    }

    fn note_repetition(&mut self, directive: &Directive<'_>, earlier: Option<usize>, what: &str) {
        if let Some(earlier) = earlier {
            let line = self.source.locate(earlier).line;
            self.warn(directive.span.clone(), &format!("the {what} of line {line} is replaced: the last one counts"));
        }
    }

    fn primitive(&mut self, directive: &Directive<'t>) -> Option<()> {
        let mut reader = self.reader(directive);
        let shape = primitive::shape(&mut reader)?;
        let mut desc = material::material(&mut reader)?;
        if let Some(texture) = material::texture(&reader) {
            match self.assets.image(&mut self.draft, texture.file, None) {
                Ok(image) => desc.texture = Some(TextureDesc { image, mode: texture.mode }),
                Err(message) => {
                    self.error(texture.span, &message, "a PNG or JPEG file beside the scene or in a search path");
                    return None;
                }
            }
        }
        self.push_object(directive, String::new(), shape, desc);
        Some(())
    }

    fn mesh(&mut self, directive: &Directive<'t>) -> Option<()> {
        let mut reader = self.reader(directive);
        let fields = mesh::mesh(&mut reader)?;
        let desc = material::material(&mut reader)?;
        let place = self.source.fault(fields.file_span.clone(), "");
        let wanted = MeshUse {
            file: fields.file,
            directive: directive.span.start,
            library_optics: (!fields.override_material).then_some(&desc),
        };
        let mesh = match self.assets.mesh(&mut self.draft, &wanted, &place) {
            Ok(mesh) => mesh?,
            Err(error) => {
                self.error(fields.file_span, &error.to_string(), "an OBJ file beside the scene or in a search path");
                return None;
            }
        };
        let shape = ShapeDesc::Mesh {
            mesh,
            transform: fields.transform,
            smooth: fields.smooth,
            override_material: fields.override_material,
        };
        self.push_object(directive, fields.file.to_owned(), shape, desc);
        Some(())
    }

    fn push_object(&mut self, directive: &Directive<'_>, name: String, shape: ShapeDesc, desc: MaterialDesc) {
        let scene = &mut self.draft.scene;
        let material = MaterialId(scene.materials.len() as u32);
        scene.materials.push(desc);
        self.draft.materials.push(MaterialOrigin::Directive(directive.span.start));
        let location = self.source.locate(directive.span.start);
        scene.objects.push(ObjectDesc { name, shape, material, location });
        self.draft.objects.push(directive.span.start);
    }

    fn comment(&mut self, span: Range<usize>) {
        let text = &self.source.text()[span.clone()];
        let text = &text[..text.floor_char_boundary(MAX_COMMENT.min(text.len()))];
        let found = comment::parameters(text);
        let shift = |part: Range<usize>| part.start + span.start..part.end + span.start;
        for (part, expected) in found.malformed {
            self.draft.report.warn(|| {
                self.source.fault(shift(part), "the run's parameters cannot be read and are ignored").expected(expected)
            });
        }
        let defaults = &mut self.draft.scene.defaults;
        let mut again = Vec::new();
        if let Some((vpl, part)) = found.vpl
            && vpl != *defaults.vpl.get_or_insert(vpl)
        {
            again.push(shift(part));
        }
        if let Some((threshold, part)) = found.threshold
            && threshold != *defaults.threshold.get_or_insert(threshold)
        {
            again.push(shift(part));
        }
        for part in again {
            self.warn(part, "other parameters were given above; the first count");
        }
    }

    fn check_completeness(&mut self) {
        let known = !self.draft.report.has_errors();
        let scene = &self.draft.scene;
        let (no_lights, no_objects) = (scene.lights.is_empty(), scene.objects.is_empty());
        if self.directives == 0 {
            self.error(
                0..0,
                "the file holds no directive, so it is no scene in the thesis' text format",
                CAMERA_EXAMPLE,
            );
        } else if self.camera.is_none() {
            self.error(0..0, "the scene has no camera", CAMERA_EXAMPLE);
        } else {
            if no_lights && known {
                self.warn(0..0, "the scene has no light");
            }
            if no_objects && known {
                self.warn(0..0, "the scene has no object");
            }
        }
    }

    /// Turns what is wrong with the finished scene into an error at the field that says so.
    fn issue(&mut self, issue: &Issue) {
        if self.draft.report.is_full() {
            return;
        }
        let (message, expected) = issue.message.split_once("; expected ").unwrap_or((&issue.message, ""));
        let fault = self.issue_fault(issue, message).expected(expected);
        self.draft.report.error(|| fault);
    }

    fn issue_fault(&self, issue: &Issue, message: &str) -> Fault {
        let field = issue.field;
        let start = match issue.subject {
            Subject::Scene => self.background,
            Subject::Camera => self.camera,
            Subject::Light(i) => self.draft.lights.get(i).copied(),
            Subject::Object(i) => self.draft.objects.get(i).copied(),
            Subject::Mesh(i) => self.draft.meshes.get(i).copied(),
            Subject::Image(_) | Subject::Environment => None,
            Subject::Material(i) => match self.draft.materials.get(i) {
                Some(MaterialOrigin::Directive(start)) => Some(*start),
                Some(MaterialOrigin::Library(library, name, start)) => {
                    if matches!(field, "specular" | "diffuse" | "ambient" | "exponent") {
                        return library.field_fault(name, field, &format!("{field} {message}"));
                    }
                    Some(*start)
                }
                None => None,
            },
        };
        let (span, name) = start.map_or((0..0, None), |start| spans::find(self.source.text(), start, field));
        let name = name.map_or_else(|| field.to_owned(), |name| format!("{name}: {}", field.replace('_', " ")));
        self.source.fault(span, &format!("{name} {message}"))
    }
}
