!> The whole body as one mesh of finite elements: how it is held and loaded, and how it answers.
module mechanics_body
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: phase_assemble, phase_factorize, phase_remesh, phase_solve, &
                          phase_tips, phase_transfer, timers_t
   use fine_contact, only: contact_t, new_contact
   use fine_elasticity, only: elasticity_t
   use fine_loads, only: fine_loads_t
   use fine_error, only: energy_error_t, estimate_error, wanted_sizes
   use fine_mesh, only: fine_mesh_t, tip_collapsed, tip_plain, tip_quarter
   use fine_model, only: fine_model_t
   use fine_recovery, only: recover_by_patches, recovery_t
   use mechanics_faces, only: face_conditions, face_pressure, given_slip, transfer_contact
   use mechanics_loads, only: body_loads, held_boundary
   use mechanics_outline, only: outline_of_scene, outline_t
   use mesh_builder, only: build_mesh, build_mesh_sized, mesh_quality, mesh_spec_t, mesher_t, &
                           transfer_mesher
   use mesh_types, only: mesh_t, network_t
   use scene_types, only: scene_t
   use tips_dual, only: correct_intensity, has_dual
   use tips_intensity, only: tip_intensity
   use tips_types, only: intensity_t
   implicit none(type, external)
   private

   public :: body_t

   !> A body on one mesh, and its state under a load.
   type :: body_t
      type(mesher_t) :: mesher
      type(mesh_t) :: mesh
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads  !< at the present load factor
      real(rk), allocatable :: displacement(:, :)  !< (2, nodes) [m]
      type(contact_t) :: contact  !< on the fracture faces, with what they have slipped before
      !> (tau n, start end mid, fracture cell) jump that the scene gives at load factor 1 [m]
      real(rk), allocatable :: given_jump(:, :, :)
      type(intensity_t), allocatable :: intensity(:)  !< (free tips of the mesh)
      type(energy_error_t) :: estimate  !< of the error; on adaptive meshes only
      real(rk) :: smallest_angle = 0.0_rk  !< of the mesh [rad]
   contains
      procedure :: build
      procedure :: refine
      procedure :: estimate_body
      procedure :: respond
      procedure :: correct_intensities
   end type body_t

contains

   !> Mesh the body with its fractures, assemble and factorize. Contact is carried over from the
   !! mesh before, if there was one.
   subroutine build(self, scene, start, network, mesh_phase, timers, error)
      class(body_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start, network  !< of the scene, and as it has grown
      integer, intent(in) :: mesh_phase  !< of the timers: the first mesh or a later one
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call timers%start(mesh_phase)
      call build_mesh(body_spec(scene, network), network, self%mesher, self%mesh, error)
      call timers%stop(mesh_phase)
      if (.not. allocated(error)) call set_up(self, scene, start, network, timers, error)
   end subroutine build

   !> A mesh whose elements have the sizes that make the error of the present state, where they
   !! lie, as small as the scene wants.
   subroutine refine(self, scene, start, network, relative, timers, error)
      class(body_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start, network  !< of the scene, and as it has grown
      real(rk), intent(in) :: relative  !< wanted error over the norm of the solution [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(mesh_spec_t) :: spec
      type(mesher_t) :: mesher
      type(mesh_t) :: mesh
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
      call set_up(self, scene, start, network, timers, error)
   end subroutine refine

   !> Rosettes as much smaller as the error around the tips asks for.
   pure subroutine fit_rosettes(mesh, shrinkage, spec)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: shrinkage(:)  !< (n_tips) new radius over the present one
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

   !> Elements, contact, conditions and factors on the present mesh.
   subroutine set_up(self, scene, start, network, timers, error)
      class(body_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start, network
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(elasticity_t) :: elasticity
      type(fine_mesh_t) :: fine_before
      type(contact_t) :: contact_before
      logical :: has_before
      integer(ik) :: worst

      call mesh_quality(self%mesher, self%smallest_angle, worst, error)
      if (allocated(error)) return
      has_before = allocated(self%displacement)
      if (has_before) then
         deallocate (self%displacement)
         fine_before = self%model%mesh
         contact_before = self%contact
      end if
      elasticity = elasticity_t(young=scene%material%young, poisson=scene%material%poisson, &
                                plane_stress=scene%material%plane_stress)
      call timers%start(phase_assemble)
      call self%model%set_mesh(self%mesh, elasticity, error, &
                               tip_element(scene%discretization%element))
      call timers%stop(phase_assemble)
      if (allocated(error)) return
      associate (fine => self%model%mesh)
         if (has_before) then
            call timers%start(phase_transfer)
            call transfer_contact(fine_before, contact_before, fine, self%contact)
            call timers%stop(phase_transfer)
         else
            self%contact = new_contact(fine)
         end if
         self%given_jump = 0.0_rk*self%contact%jump
         call given_slip(scene, start, network, fine, self%given_jump)
         call timers%start(phase_factorize)
         call self%model%prepare(face_conditions(scene, start, fine), error, &
                                 held_boundary(scene, fine))
         call timers%stop(phase_factorize)
      end associate
   end subroutine set_up

   !> The element around the tips by its name.
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

   !> Elements within reach of a point load: the size of elements far from fractures, which leaves
   !! about one of them on each side of the load.
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

   !> Estimate the error of the present state, near point loads left out.
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

   !> What to mesh.
   pure function body_spec(scene, network) result(spec)
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      type(mesh_spec_t) :: spec
      type(outline_t) :: outline
      integer :: f

      outline = outline_of_scene(scene)
      spec%corners = outline%corners
      spec%edge_side = outline%edge_side
      spec%fixed_points = outline%fixed_points
      spec%size_boundary = scene%discretization%size_boundary
      spec%size_fracture = scene%discretization%size_fracture
      if (.not. spec%size_fracture > 0.0_rk) spec%size_fracture = spec%size_boundary
      spec%rosette_sectors = scene%discretization%rosette_sectors
      spec%rosette_radius = scene%discretization%rosette_radius
      if (.not. spec%rosette_radius > 0.0_rk) spec%rosette_radius = spec%size_fracture
      ! Two elements fit on the last straight piece, for the domain of the interaction integral
      ! ends at a kink.
      allocate (spec%end_radius(2, size(network%first) - 1))
      do f = 1, size(network%first) - 1
         associate (first => network%first(f), last => network%first(f + 1) - 1)
            spec%end_radius(1, f) = norm2(network%xy(:, first + 1) - network%xy(:, first))
            spec%end_radius(2, f) = norm2(network%xy(:, last) - network%xy(:, last - 1))
         end associate
      end do
      spec%end_radius = min(spec%rosette_radius, 0.5_rk*spec%end_radius)
   end function body_spec

   !> Displacements, and stress intensity factors where the scene wants them, at a load factor.
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
      do tip = 1, self%mesh%fracture%n_tips
         call tip_intensity(self%model, self%loads, self%displacement, tip, self%intensity(tip), &
                            error)
         if (allocated(error)) exit
      end do
      call timers%stop(phase_tips)
   end subroutine respond

   !> Errors of the intensities from that of the whole solution, where no faces touch.
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
         call correct_intensity(self%model, self%displacement, recovery, tip, &
                                self%intensity(tip), error)
         if (allocated(error)) exit
      end do
      call timers%stop(phase_tips)
   end subroutine correct_intensities

end module mechanics_body
