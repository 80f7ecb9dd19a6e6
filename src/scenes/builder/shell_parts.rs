//! Shells whose groups of faces have sections of their own.

use super::shells::SectionOf;
use super::{FreeMesh, MechanismBuilder, MeshedShell, SurfaceMesh};
use crate::elements::flexible::{Laminate, Material, ShellSection};
use crate::scalar::{Scalar, Vector3};

/// The section of some faces of a shell.
pub enum ShellPart<'p, S> {
    /// One material, with the thickness \[m\] at each point of a face, from the numbers of both; continuous if it does not depend on the
    /// face.
    Isotropic(Material<S>, &'p dyn Fn(usize, usize) -> S),
    /// Plies, with the direction of their axis 1 in the world.
    Laminate(&'p Laminate<S>, Vector3<S>),
}

impl<S: Scalar> MechanismBuilder<S> {
    /// A shell on a free mesh whose faces have sections of their own: which of `parts`, from the number of the face.
    pub fn shell_of_parts(
        &mut self,
        name: &str,
        mesh: FreeMesh<S>,
        parts: &[ShellPart<S>],
        part_of: impl Fn(usize) -> usize,
    ) -> MeshedShell {
        let wrong = (0..mesh.faces.len()).find(|&face| part_of(face) >= parts.len());
        if let Some(face) = wrong {
            let (count, face_name, own) = (parts.len(), mesh.element_place(face), part_of(face));
            self.mistakes.push(format!("\"{name}\", {face_name} has part {own}, but there are {count}, counted from 0"));
        }
        type Numbers<'n, S> = Box<dyn Fn(usize, usize) -> Vec<S> + 'n>;
        type OwnSection<'n, S> = (ShellSection, Numbers<'n, S>, Option<&'n Laminate<S>>);
        let mut sections: Vec<OwnSection<S>> = Vec::new();
        for part in parts {
            sections.push(match part {
                ShellPart::Isotropic(Material { young, poisson, density }, thickness) => {
                    self.check_poisson(name, *poisson);
                    let mesh = &mesh;
                    let numbers = move |face: usize, nodes: usize| {
                        let own = (0..nodes).map(|node| thickness(face, mesh.place(face, node)));
                        own.chain([*young, *poisson, *density]).collect()
                    };
                    (ShellSection::Isotropic, Box::new(numbers), None)
                }
                ShellPart::Laminate(laminate, direction) => {
                    let numbers = self.laminate_numbers(name, &mesh, laminate, *direction);
                    (ShellSection::Laminate, Box::new(move |_, _| numbers.clone()), Some(*laminate))
                }
            });
        }
        if wrong.is_some() {
            // a mechanism with mistakes is not made: its faces may have any section
            let any = |_: usize, nodes: usize| vec![S::from(1.0); nodes + 3];
            return self.add_shell(name, &mesh, &mesh, &[(ShellSection::Isotropic, &any, None)], &|_| 0);
        }
        let sections: Vec<SectionOf<S>> =
            sections.iter().map(|(section, numbers, plies)| (*section, &**numbers, *plies)).collect();
        let before = self.mistakes.len();
        let shell = self.add_shell(name, &mesh, &mesh, &sections, &part_of);
        if self.mistakes.len() > before {
            return shell;
        }
        let directors = mesh.directors();
        for (number, part) in parts.iter().enumerate() {
            if let ShellPart::Laminate(_, direction) = part {
                let own = directors.iter().enumerate().filter(|(face, _)| part_of(*face) == number);
                self.check_axis(name, *direction, own.flat_map(|(_, normals)| normals.iter().copied()));
            }
        }
        shell
    }
}
