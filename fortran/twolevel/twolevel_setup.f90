!> What a scene with a fluid prescribes: expected magnitudes of its results, parameters of growth,
!! the coarse mesh, and the fracture cells at the start.
module twolevel_setup
   use base_kinds, only: ik, pi, rk
   use coarse_in_situ, only: find_in_situ, in_situ_state_t
   use coarse_state, only: fracture_cells_t
   use growth_rules, only: growth_rules_t
   use mesh_builder, only: mesh_spec_t
   use mesh_types, only: fracture_mesh_t
   use report_scene, only: follow_outlines, law_of_fracture, set_own_sizes, shape_body
   use scene_outline, only: outline_of_scene, outline_t
   use scene_types, only: scene_t
   use twolevel_rock_around, only: refine_at_wells
   use twolevel_schedule, only: shortest_stage
   use twolevel_stepping, only: first_step, step_scale
   implicit none(type, external)
   private

   public :: choose_first_step, coarse_spec, first_cells, keep_above_zero, pressure_scale
   public :: rest_joints, rules_of_scene

   !> Relative deficit of K_eq within which tips grow along with the first: the two methods for the
   !! intensities differ by about as much [-].
   real(rk), parameter :: together = 0.01_rk

   !> Shortest path segment, over the increment and over a coarse cell: coarse meshes with shorter
   !! ones have angles below 10 degrees [-].
   real(rk), parameter :: shortest_segment = 1.0_rk/16.0_rk, shortest_in_mesh = 0.1_rk

   !> Distance from the path within which ends and kinks of fractures lie on the path, in increments
   !! and in cells: no mesh of good quality fits between [-].
   real(rk), parameter :: near_way = 0.02_rk, near_in_mesh = 5.0e-3_rk

contains

   !> Set the first step of the run, or of a stage of it that is much shorter than the run: with it
   !! it is determined where layers are resolved, and how finely.
   subroutine choose_first_step(scene, first)
      type(scene_t), intent(in) :: scene
      real(rk), intent(inout) :: first  !< [s]
      real(rk), parameter :: share = 1.0e-4_rk  ! first step of a stage, over its length [-]

      if (scene%discretization%layers /= "auto") return
      first = step_scale(scene%time)
      if (scene%time%tolerance > 0.0_rk) first = min(first_step(scene%time), &
                                                     share*shortest_stage(scene))
   end subroutine choose_first_step

   !> Replace a toughness of 0, or next to it, by one that changes nothing that a run resolves: K_eq
   !! over it is a finite number, viscosity has its limit without toughness (coarse_tip_layer), and
   !! a tip that is shut lacks more of it than the tolerance of equilibrium.
   pure subroutine keep_above_zero(scene)
      type(scene_t), intent(inout) :: scene
      real(rk), parameter :: negligible = 2.0e-4_rk  ! share of K at the pressure of the loads
      real(rk), parameter :: strain = 1.0e-10_rk  ! where there are none
      real(rk) :: least
      integer :: i

      least = negligible*max(pressure_scale(scene), strain*scene%material%young) &
              *sqrt(0.5_rk*pi*longest_fracture(scene))
      scene%material%toughness = max(least, scene%material%toughness)
      do i = 1, size(scene%fractures)
         scene%fractures(i)%toughness = max(least, scene%fractures(i)%toughness)
      end do
      if (.not. allocated(scene%regions)) return
      do i = 1, size(scene%regions)
         scene%regions(i)%material%toughness = max(least, scene%regions(i)%material%toughness)
      end do
   end subroutine keep_above_zero

   !> Largest pressure expected in a scene [Pa]: that of its loads or of its initial state, stress
   !! in situ included, and with growth the pressure at which the longest fracture reaches its
   !! toughness; 0 without any of these.
   pure real(rk) function pressure_scale(scene) result(scale)
      type(scene_t), intent(in) :: scene
      real(rk), parameter :: half_pi = 0.5_rk*pi
      type(in_situ_state_t), allocatable :: in_situ
      real(rk) :: extent, longest
      integer :: i

      associate (d => scene%domain)
         extent = min(d%x_max - d%x_min, d%y_max - d%y_min)
      end associate
      scale = abs(scene%initial%pressure)
      do i = 1, size(scene%sides)
         associate (side => scene%sides(i))
            scale = max(scale, side%largest_stress(), &
                        scene%material%young*side%largest_displacement()/extent)
         end associate
      end do
      call find_in_situ(scene, scene%material%biot, in_situ)
      if (allocated(in_situ)) then
         associate (y => [scene%domain%y_min, scene%domain%y_max])
            scale = max(scale, maxval(abs(in_situ%pressure_at(y))), &
                        maxval(abs(in_situ%stress_at(y(1)))), maxval(abs(in_situ%stress_at(y(2)))))
         end associate
      end if
      longest = longest_fracture(scene)
      if (scene%growth%enabled .and. longest > 0.0_rk) then
         scale = max(scale, scene%material%toughness/sqrt(half_pi*longest))
      end if
   end function pressure_scale

   !> Length of the longest fracture [m].
   pure real(rk) function longest_fracture(scene) result(longest)
      type(scene_t), intent(in) :: scene
      integer :: i

      longest = 0.0_rk
      do i = 1, size(scene%fractures)
         longest = max(longest, scene%fractures(i)%length())
      end do
   end function longest_fracture

   !> Parameters of growth: with increments of prescribed length tips join targets at once, in
   !! equilibrium once the ligament breaks.
   pure function rules_of_scene(scene) result(rules)
      type(scene_t), intent(in) :: scene
      type(growth_rules_t) :: rules
      type(outline_t) :: outline
      integer(ik) :: f, n

      outline = outline_of_scene(scene)
      rules = growth_rules_t(toughness=scene%material%toughness, &
                             increment=scene%growth%increment, &
                             stop_gain=scene%growth%stop_gain, exponent=scene%growth%exponent, &
                             together=together, &
                             joins=scene%growth%law /= "equilibrium", heads=.true., &
                             shortest=merge(shortest_segment, 1.0_rk, &
                                            scene%growth%in_equilibrium()), &
                             shortest_length=shortest_in_mesh*scene%discretization%size_fracture, &
                             near=max(near_way*scene%growth%increment, &
                                      near_in_mesh*scene%discretization%size_fracture), &
                             outline=outline%corners)
      n = size(scene%fractures, kind=ik)
      if (all(.not. scene%fractures%increment > 0.0_rk) .and. &
          all(.not. scene%fractures%cell_size > 0.0_rk)) return
      rules%own_increment = [(scene%increment_of(f), f=1, n)]
      rules%increment = minval(rules%own_increment)
      rules%own_near = [(max(near_way*scene%increment_of(f), &
                             near_in_mesh*scene%cell_size_of(f)), f=1, n)]
   end function rules_of_scene

   !> Specification of the coarse mesh.
   pure function coarse_spec(scene) result(spec)
      type(scene_t), intent(in) :: scene
      type(mesh_spec_t) :: spec

      spec = mesh_spec_t(x_min=scene%domain%x_min, x_max=scene%domain%x_max, &
                         y_min=scene%domain%y_min, y_max=scene%domain%y_max, &
                         size_fracture=scene%discretization%size_fracture, &
                         size_boundary=scene%discretization%size_boundary)
      if (size(scene%fractures) == 0) spec%size_fracture = spec%size_boundary
      call set_own_sizes(scene, spec)
      call shape_body(scene, spec)
      if (allocated(scene%regions)) then
         call follow_outlines(scene%regions, scene%domain, spec)
         call refine_at_wells(scene, spec)
      end if
      if (.not. allocated(scene%heat)) return
      if (.not. scene%heat%source_cell_size > 0.0_rk) return
      associate (heat => scene%heat)
         call spec%refine(transpose(reshape([heat%source_x, heat%source_y], &
                                            [size(heat%source_x), 2])), heat%source_cell_size)
      end associate
   end function coarse_spec

   !> Contact law and residual aperture of the fracture cells of the scene.
   pure subroutine first_cells(scene, fracture, cells)
      type(scene_t), intent(in) :: scene
      type(fracture_mesh_t), intent(in) :: fracture
      type(fracture_cells_t), intent(inout) :: cells
      integer(ik) :: i

      associate (n => fracture%n_cells)
         allocate (cells%law(n), cells%residual_aperture(n))
         allocate (cells%injection(n), cells%roughness(n), source=0.0_rk)
      end associate
      do i = 1, fracture%n_cells
         associate (given => scene%fractures(fracture%cell_fracture(i)))
            cells%law(i) = law_of_fracture(given)
            cells%residual_aperture(i) = given%aperture
         end associate
      end do
      if (any(scene%fractures%skin > 0.0_rk)) then
         cells%skin = scene%fractures(fracture%cell_fracture)%skin
      end if
   end subroutine first_cells

   !> Joints are closed under the stress in situ without a jump: subtract this closure.
   pure subroutine rest_joints(in_situ, fracture, cells)
      type(in_situ_state_t), intent(in) :: in_situ
      type(fracture_mesh_t), intent(in) :: fracture
      type(fracture_cells_t), intent(inout) :: cells
      real(rk) :: closed, slope
      integer(ik) :: i

      if (.not. in_situ%is_held) return
      do i = 1, fracture%n_cells
         if (.not. cells%law(i)%compliance > 0.0_rk) cycle
         call cells%law(i)%closure(in_situ%contact_pressure(fracture, i), closed, slope)
         cells%law(i)%closure_at_rest = closed
         cells%residual_aperture(i) = cells%residual_aperture(i) - closed
      end do
   end subroutine rest_joints

end module twolevel_setup
