!> The whole body as one mesh of finite elements: its supports, its loads, and its response.
module mechanics_body
   use, intrinsic :: iso_c_binding, only: c_loc
   use base_archive, only: archive_t
   use base_errors, only: error_t
   use base_kinds, only: ik, lk, rk
   use base_plane, only: norm2
   use base_timers, only: phase_assemble, phase_factorize, phase_mesh, phase_remesh, phase_solve, &
                          phase_tips, phase_transfer, timers_t
   use fine_archive, only: set_fine_extents, visit_contact, visit_fine_mesh, visit_loads
   use fine_boundary, only: add_side_springs
   use fine_contact, only: contact_t, new_contact, transfer_contact
   use fine_elasticity, only: elasticity_t
   use fine_error, only: correct_intensity, energy_error_t, estimate_error, has_dual, wanted_sizes
   use fine_loads, only: fine_loads_t
   use fine_mesh, only: fine_mesh_t, tip_collapsed, tip_plain, tip_quarter
   use fine_model, only: fine_model_t
   use fine_recovery, only: recover_by_patches, recovery_t
   use fine_tip_intensity, only: probe_of_tip, tip_intensity
   use fine_tip_interaction, only: tip_probe_t
   use fine_tip_types, only: intensity_t
   use growth_network, only: end_pieces
   use mechanics_faces, only: body_loads, face_conditions, held_boundary, prescribe_slip
   use mesh_archive, only: visit_mesher, visit_mesher_and_mesh
   use mesh_builder, only: build_mesh, build_mesh_sized, corner_share, grow_mesh, mesh_quality, &
                           mesh_spec_t, mesher_t, transfer_mesher
   use mesh_types, only: mesh_t, network_t
   use report_corners, only: joints_of_scene, kinks_of_scene
   use report_scene, only: follow_outlines, interface_distance, keep_off, place_rocks, &
                           regions_of_other_rock, set_own_sizes
   use scene_fluid_law, only: bulk_modulus
   use scene_outline, only: outline_of_scene, outline_t, sides_of_scene
   use scene_types, only: material_t, scene_t
   implicit none(type, external)
   private

   public :: body_spec, body_t

   !> The mesh before an increment of growth.
   type :: before_t
      type(mesher_t) :: mesher
      type(fine_mesh_t) :: fine
      type(contact_t) :: contact
   end type before_t

   !> A body on one mesh, and its state under a load.
   type :: body_t
      type(mesher_t) :: mesher
      type(mesh_t) :: mesh
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads  !< at the present load factor
      real(rk), allocatable :: displacement(:, :)  !< (2, nodes) [m]
      type(contact_t) :: contact  !< contact of the fracture faces, with the accepted slip
      !> (tau n, start end mid, fracture cell) prescribed jump at load factor 1 [m]
      real(rk), allocatable :: given_jump(:, :, :)
      type(intensity_t), allocatable :: intensity(:)  !< (free tips of the mesh)
      type(tip_probe_t), allocatable :: probe(:)  !< (free tips of the mesh) evaluation of intensity
      type(energy_error_t) :: estimate  !< estimated error; on adaptive meshes only
      real(rk) :: smallest_angle = 0.0_rk  !< smallest angle of the mesh [rad]
      type(before_t) :: before
      integer(ik) :: whole_meshes = 0  !< meshes of the whole body so far
      integer(ik) :: patched_meshes = 0  !< meshes changed around tips only
   contains
      procedure :: build
      procedure :: set_up
      procedure :: find_probes
      procedure :: remember
      procedure :: grow
      procedure :: refine
      procedure :: estimate_body
      procedure :: respond
      procedure :: correct_intensities
      procedure :: visit
   end type body_t

contains

   !> Mesh the body with its fractures, assemble and factorize.
   subroutine build(self, scene, start, network, timers, error)
      class(body_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start, network  !< initial and grown network
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call timers%start(phase_mesh)
      call build_mesh(body_spec(scene, network), network, self%mesher, self%mesh, error)
      self%whole_meshes = self%whole_meshes + 1
      call timers%stop(phase_mesh)
      if (allocated(error)) return
      call set_up(self, scene, start, network, timers, error)
   end subroutine build

   !> Keep the present mesh, from which all meshes of the next increment are made.
   subroutine remember(self)
      class(body_t), intent(inout) :: self

      call transfer_mesher(self%mesher, self%before%mesher)
      self%before%fine = self%model%mesh
      self%before%contact = self%contact
   end subroutine remember

   !> Mesh the body with fractures that have grown since `remember`, around their ends only or, if
   !! that fails, as a whole; assemble and factorize. Contact is transferred.
   subroutine grow(self, scene, start, network, timers, error)
      class(body_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start, network  !< initial and grown network
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(error_t), allocatable :: no_patch
      real(rk) :: radii(2, size(network%first) - 1)
      integer(ik) :: tip

      call timers%start(phase_remesh)
      radii = end_radii(scene, network)
      if (scene%adaptive%enabled) then  ! rosettes remain as small as the error required
         associate (fracture => self%before%fine%fracture)
            do tip = 1, fracture%n_tips
               associate (radius => radii(fracture%tip_end(tip), fracture%tip_fracture(tip)))
                  radius = min(radius, fracture%tip_radius(tip))
               end associate
            end do
         end associate
      end if
      call grow_mesh(self%before%mesher, network, radii, self%mesher, self%mesh, no_patch)
      if (allocated(no_patch)) then
         call build_mesh(body_spec(scene, network), network, self%mesher, self%mesh, error)
         self%whole_meshes = self%whole_meshes + 1
      else
         self%patched_meshes = self%patched_meshes + 1
      end if
      call timers%stop(phase_remesh)
      if (.not. allocated(error)) then
         call set_up(self, scene, start, network, timers, error, self%before%fine, &
                     self%before%contact)
      end if
   end subroutine grow

   !> Mesh the body with element sizes for a given error of the present state.
   subroutine refine(self, scene, start, network, relative, timers, error)
      class(body_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start, network  !< initial and grown network
      real(rk), intent(in) :: relative  !< target error over the norm of the solution [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(mesh_spec_t) :: spec
      type(mesher_t) :: mesher
      type(mesh_t) :: mesh
      type(fine_mesh_t) :: fine_before
      type(contact_t) :: contact_before
      real(rk), allocatable :: sizes(:), shrinkage(:)

      call timers%start(phase_remesh)
      call wanted_sizes(self%model%mesh, self%estimate, relative, sizes, shrinkage)
      spec = body_spec(scene, network)
      call fit_rosettes(self%mesh, shrinkage, spec)
      call build_mesh_sized(spec, network, self%mesher, sizes, mesher, mesh, error)
      call timers%stop(phase_remesh)
      if (allocated(error)) return
      call transfer_mesher(mesher, self%mesher)
      self%mesh = mesh
      self%whole_meshes = self%whole_meshes + 1
      fine_before = self%model%mesh
      contact_before = self%contact
      call set_up(self, scene, start, network, timers, error, fine_before, contact_before)
   end subroutine refine

   !> Reduce the rosettes as the error around the tips requires.
   pure subroutine fit_rosettes(mesh, shrinkage, spec)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: shrinkage(:)  !< (n_tips) new radius over the present one [-]
      type(mesh_spec_t), intent(inout) :: spec
      integer(ik) :: tip

      associate (fracture => mesh%fracture)
         do tip = 1, fracture%n_tips
            associate (radius => spec%end_radius(fracture%tip_end(tip), fracture%tip_fracture(tip)))
               radius = min(radius, shrinkage(tip)*fracture%tip_radius(tip))
            end associate
         end do
      end associate
   end subroutine fit_rosettes

   !> Set up elements, contact, conditions and factors on the present mesh; contact is transferred
   !! from a previous mesh if that is present.
   subroutine set_up(self, scene, start, network, timers, error, fine_before, contact_before)
      class(body_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start, network
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(fine_mesh_t), intent(in), optional :: fine_before
      type(contact_t), intent(in), optional :: contact_before
      integer(ik) :: side, worst

      call mesh_quality(self%mesher, self%smallest_angle, worst, error)
      if (allocated(error)) return
      if (allocated(self%displacement)) deallocate (self%displacement)
      if (allocated(self%probe)) deallocate (self%probe)
      call timers%start(phase_assemble)
      if (allocated(scene%regions)) then
         associate (all => [elasticity(scene%material), elasticity(scene%regions%material)])
            call self%model%set_mesh(self%mesh, all(1), error, &
                                     tip_element(scene%discretization%element), &
                                     place_rocks(scene, self%mesh, all))
         end associate
      else
         call self%model%set_mesh(self%mesh, elasticity(scene%material), error, &
                                  tip_element(scene%discretization%element))
      end if
      call timers%stop(phase_assemble)
      if (allocated(error)) return
      associate (sides => sides_of_scene(scene))
         do side = 1, size(sides, kind=ik)
            call add_side_springs(self%model%mesh, side, sides(side)%spring, self%model%stiffness)
         end do
      end associate
      associate (fine => self%model%mesh)
         self%contact = new_contact(fine)
         if (present(fine_before) .and. present(contact_before)) then
            call timers%start(phase_transfer)
            call transfer_contact(fine_before, contact_before, fine, self%contact)
            call timers%stop(phase_transfer)
         end if
         self%given_jump = 0.0_rk*self%contact%jump
         call prescribe_slip(scene, start, network, fine, self%given_jump)
         call timers%start(phase_factorize)
         call self%model%prepare(face_conditions(scene, start, fine), error, &
                                 held_boundary(scene, fine))
         call timers%stop(phase_factorize)
      end associate
   end subroutine set_up

   !> Elastic constants of a rock.
   elemental function elasticity(material) result(constants)
      type(material_t), intent(in) :: material
      type(elasticity_t) :: constants

      constants = elasticity_t(young=material%young, poisson=material%poisson, &
                               plane_stress=material%plane_stress, &
                               biot=bulk_modulus(material)*material%heat_expansion)
      if (material%plane_stress) then
         associate (nu => material%poisson)
            constants%biot = constants%biot*(1.0_rk - 2.0_rk*nu)/(1.0_rk - nu)
         end associate
      end if
   end function elasticity

   !> Number of the element around the tips from its name.
   pure integer(ik) function tip_element(name)
      character(len=*), intent(in) :: name

      select case (name)
      case ("collapsed")
         tip_element = tip_collapsed
      case ("plain")
         tip_element = tip_plain
      case default
         tip_element = tip_quarter
      end select
   end function tip_element

   !> Elements near a point load, within the size of elements far from fractures: about one element
   !! on each side of the load.
   pure function near_point_loads(scene, fine) result(is_near)
      type(scene_t), intent(in) :: scene
      type(fine_mesh_t), intent(in) :: fine
      logical :: is_near(fine%n_cells)
      integer(ik) :: cell, i, k

      is_near = .false.
      do i = 1, size(scene%point_loads, kind=ik)
         associate (point => scene%point_loads(i), reach => scene%discretization%size_boundary)
            do cell = 1, fine%n_cells
               do k = 1, 3
                  if (norm2(fine%xy(:, fine%cell_nodes(k, cell)) - [point%x, point%y]) < reach) then
                     is_near(cell) = .true.
                  end if
               end do
            end do
         end associate
      end do
   end function near_point_loads

   !> Estimate the error of the present state without the elements near point loads.
   subroutine estimate_body(self, scene, timers)
      class(body_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(timers_t), intent(inout) :: timers
      type(recovery_t) :: recovery

      call timers%start(phase_remesh)
      call recover_by_patches(self%model, self%displacement, recovery)
      call estimate_error(self%model, self%displacement, recovery, self%estimate, &
                          near_point_loads(scene, self%model%mesh))
      call timers%stop(phase_remesh)
   end subroutine estimate_body

   !> Specification of the mesh of the body.
   pure function body_spec(scene, network) result(spec)
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      type(mesh_spec_t) :: spec
      type(outline_t) :: outline

      outline = outline_of_scene(scene)
      spec%corners = outline%corners
      spec%edge_side = outline%edge_side
      spec%fixed_points = outline%fixed_points
      spec%size_boundary = scene%discretization%size_boundary
      spec%size_fracture = scene%discretization%size_fracture
      if (.not. spec%size_fracture > 0.0_rk) spec%size_fracture = spec%size_boundary
      call set_own_sizes(scene, spec)
      call spec%refine(kinks_of_scene(scene), corner_share*spec%size_fracture)
      call spec%refine(joints_of_scene(scene), corner_share*spec%size_fracture)
      spec%rosette_sectors = scene%discretization%rosette_sectors
      spec%rosette_radius = scene%discretization%rosette_radius
      spec%end_radius = end_radii(scene, network)
      if (any(regions_of_other_rock(scene))) then
         call follow_outlines(scene%regions, scene%domain, spec)
      end if
   end function body_spec

   !> Largest radii of the rosettes at the starts and ends of the fractures [m]. Two elements fit on
   !! the last straight part, since the domain of the interaction integral ends at a kink.
   pure function end_radii(scene, network) result(radii)
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      real(rk) :: radii(2, size(network%first) - 1)
      integer(ik) :: fracture

      radii = 0.5_rk*end_pieces(network)
      do fracture = 1, size(radii, 2, kind=ik)
         radii(:, fracture) = min(scene%rosette_radius_of(fracture), radii(:, fracture))
      end do
      if (.not. any(regions_of_other_rock(scene))) return
      do fracture = 1, size(radii, 2, kind=ik)
         associate (first => network%first)
            radii(1, fracture) = min(radii(1, fracture), 0.5_rk*interface_distance(scene, &
                                                                    network%xy(:, first(fracture))))
            radii(2, fracture) = min(radii(2, fracture), 0.5_rk*interface_distance(scene, &
                                                            network%xy(:, first(fracture + 1) - 1)))
         end associate
      end do
   end function end_radii

   !> Refuse a tip on or next to an interface, which has no intensities.
   subroutine refuse_interface(self, scene, tip, error)
      type(body_t), intent(in) :: self
      type(scene_t), intent(in) :: scene
      integer(ik), intent(in) :: tip  !< of the mesh
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: radius

      if (.not. allocated(scene%regions)) return
      radius = scene%rosette_radius_of(self%mesh%fracture%tip_fracture(tip))
      call keep_off(self%mesh%xy(:, self%mesh%fracture%tip_node(tip)), scene, radius, error)
   end subroutine refuse_interface

   !> Find displacements and, with intensities, stress intensity factors at a load factor.
   subroutine respond(self, scene, factor, timers, error)
      class(body_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: factor  !< [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: tip

      call timers%start(phase_solve)
      self%loads = body_loads(scene, self%model%mesh, factor)
      self%loads%jump = factor*self%given_jump
      call self%model%solve(self%loads, self%displacement, error, self%contact)
      call timers%stop(phase_solve)
      if (allocated(error) .or. .not. scene%growth%intensities) return
      call timers%start(phase_tips)
      if (allocated(self%intensity)) deallocate (self%intensity)
      allocate (self%intensity(self%mesh%fracture%n_tips))
      if (.not. allocated(self%probe)) call find_probes(self, scene, error)
      do tip = 1, self%mesh%fracture%n_tips
         if (allocated(error)) exit
         call tip_intensity(self%model, self%loads, self%displacement, self%probe(tip), &
                            self%intensity(tip), error)
      end do
      call timers%stop(phase_tips)
   end subroutine respond

   !> Prepare the evaluation of the intensities of the tips of the mesh.
   subroutine find_probes(self, scene, error)
      class(body_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      type(tip_probe_t) :: probe(self%mesh%fracture%n_tips)
      integer(ik) :: tip

      do tip = 1, self%mesh%fracture%n_tips
         call refuse_interface(self, scene, tip, error)
         if (.not. allocated(error)) call probe_of_tip(self%model, tip, probe(tip), error)
         if (allocated(error)) return
      end do
      self%probe = probe
   end subroutine find_probes

   !> Estimate the errors of the intensities from that of the whole solution, if no faces touch.
   subroutine correct_intensities(self, timers, error)
      class(body_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(recovery_t) :: recovery
      integer(ik) :: tip

      if (self%mesh%fracture%n_tips == 0 .or. .not. has_dual(self%model)) return
      call timers%start(phase_tips)
      call recover_by_patches(self%model, self%displacement, recovery)
      do tip = 1, self%mesh%fracture%n_tips
         call correct_intensity(self%model, self%displacement, recovery, &
                                self%probe(tip), self%intensity(tip), error)
         if (allocated(error)) exit
      end do
      call timers%stop(phase_tips)
   end subroutine correct_intensities

   !> Store or load a body; its model is made again from its mesh.
   subroutine visit(self, archive, scene, start, network, timers, error)
      class(body_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start, network
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      logical :: has_probes

      call archive%enter("body")
      call visit_mesher_and_mesh(archive, "mesh", self%mesher, self%mesh)
      if (archive%is_loading .and. .not. allocated(archive%fault)) then
         if (self%mesh%n_cells == 0) then
            call archive%set_fault("mesh")
         else
            call archive%compare_range("mesh", self%mesh%face_side, "; 0:sides")
         end if
         if (allocated(archive%fault)) return
         call self%set_up(scene, start, network, timers, error)
         if (allocated(error)) return
      end if
      call set_fine_extents(archive, self%model%mesh)
      call visit_loads(archive, "loads", self%loads)
      call archive%list("displacement", self%displacement, "2, fine_nodes ?")
      call visit_contact(archive, "contact", self%contact)
      call archive%list("given_jump", self%given_jump, "2, 3, fine_faces ?")
      call visit_intensities(archive, self%intensity)
      has_probes = allocated(self%probe)
      call archive%item("has_probes", has_probes)
      call archive%list("error", self%estimate%element)
      call archive%list("error_left_out", self%estimate%left_out)
      call archive%item("error_total", self%estimate%total)
      call archive%item("error_solution", self%estimate%solution)
      call archive%item("error_relative", self%estimate%relative)
      call archive%item("smallest_angle", self%smallest_angle)
      call visit_mesher(archive, "mesher_before", self%before%mesher)
      call visit_fine_mesh(archive, "fine_before", self%before%fine)
      call visit_contact(archive, "contact_before", self%before%contact)
      call archive%item("whole_meshes", self%whole_meshes)
      call archive%item("patched_meshes", self%patched_meshes)
      call archive%leave()
      if (allocated(archive%fault)) return
      if (archive%is_loading .and. has_probes) call self%find_probes(scene, error)
   end subroutine visit

   subroutine visit_intensities(archive, intensity)
      type(archive_t), intent(inout) :: archive
      type(intensity_t), allocatable, intent(inout), target :: intensity(:)
      integer(lk) :: n

      call archive%extent("intensity", intensity, n)
      if (archive%is_loading) then
         if (allocated(intensity)) deallocate (intensity)
         if (n >= 0_lk) allocate (intensity(n))
      end if
      if (n > 0_lk) call archive%plain("intensity", c_loc(intensity), &
                                       n*storage_size(intensity)/8_lk)
   end subroutine visit_intensities

end module mechanics_body
