!> Steady flow through a unit square with regions, from the left side to the right one, bottom and
!! top closed (verification/regions).
!!
!! Arguments: which layers, mesh size [m], method: `followed`, as a scene has it; `mixed`: cells do
!! not follow the outlines, but have the layered mean of what they cut; `centres`: each cell has the
!! permeability at its centre. The last two are for comparison. A fourth: how much more the layer in
!! the middle conducts than the one beside it, 100 if not given.
!! Pressure difference and viscosity are 1, permeabilities about 1, so the flow is a conductance.
program layered_flow
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_model, only: coarse_model_t, new_state
   use coarse_rock, only: resistivity_of
   use coarse_state, only: state_t, step_report_t
   use coarse_stencils, only: discretize
   use mesh_builder, only: build_mesh, mesh_spec_t, mesher_t
   use mesh_geometry, only: cell_area, face_length
   use mesh_types, only: mesh_t, network_t
   use scene_types, only: initial_t, region_t, scene_t
   use twolevel_setup, only: coarse_spec
   use verification_files, only: finish, real_argument, stop_on, table_t, text_argument
   use verification_meshes, only: cell_centre
   implicit none(type, external)

   real(rk) :: contrast  !< of the layer in the middle
   type(scene_t) :: scene
   type(mesh_spec_t) :: spec
   type(network_t) :: network
   type(mesher_t) :: mesher
   type(mesh_t) :: mesh
   type(coarse_model_t) :: model
   type(state_t) :: state
   type(timers_t) :: timers
   type(step_report_t) :: report
   type(error_t), allocatable :: error
   type(table_t) :: table
   integer :: region
   real(rk) :: exact
   integer :: step

   scene%domain%x_max = 1.0_rk
   scene%domain%y_max = 1.0_rk
   scene%material%young = 1.0e9_rk
   scene%material%poisson = 0.2_rk
   scene%material%porosity = 1.0_rk
   scene%material%biot = 1.0_rk
   scene%material%storage = "textbook"
   scene%fluid%viscosity = 1.0_rk
   scene%fluid%compressibility = 1.0e-6_rk
   scene%sides%displacement_given(1) = .true.
   scene%sides%displacement_given(2) = .true.
   scene%sides(:2)%pressure_given = .true.
   scene%sides(1)%pressure = 1.0_rk
   contrast = 100.0_rk
   if (command_argument_count() > 3) contrast = real_argument(4)
   call set_layers(text_argument(1))
   do region = 1, size(scene%regions)  ! but for their permeability they are of one rock
      associate (own => scene%regions(region)%material, all => scene%material)
         own%young = all%young
         own%poisson = all%poisson
         own%biot = all%biot
         own%porosity = all%porosity
         own%storage = all%storage
      end associate
   end do

   allocate (scene%fractures(0))
   scene%discretization%size_boundary = real_argument(2)
   spec = coarse_spec(scene)
   if (text_argument(3) /= "followed") deallocate (spec%guides, spec%guide_count)
   allocate (network%first(1), source=1_ik)
   allocate (network%xy(2, 0), network%s_start(0))
   call build_mesh(spec, network, mesher, mesh, error)
   call stop_on(error)
   allocate (model%cells%law(0), model%cells%residual_aperture(0), model%cells%injection(0))
   call model%set_mesh(mesh, scene, timers, error)
   call stop_on(error)
   if (text_argument(3) == "centres") call take_centres()
   call new_state(mesh, model%cells, initial_t(), model, state)
   do step = 1, 3
      call model%advance(mesh, 1.0e6_rk, state, timers, report, error)
      call stop_on(error)
   end do
   call table%open("flow.csv", "flow,exact,pressure_l2,cells,beyond")
   call table%row([flow_out(), exact, pressure_error(), real(mesh%n_cells, rk), &
                   beyond_bounds()])
   call table%close()
   call finish()

contains

   !> The regions, and the exact conductance.
   !!
   !! Layers across the flow conduct as 1/sum(length/K), layers along it as sum(height K). For the
   !! others, flux and gradient of a flow, turned by a right angle and exchanged, are those of a
   !! flow from bottom to top through K/det K (Keller 1964; Dykhne 1970): where det K is the same
   !! everywhere, and x and y can be exchanged, the conductance is sqrt(det K); where two isotropic
   !! rocks change places if x and y are exchanged, it is sqrt(K1 K2).
   subroutine set_layers(name)
      character(len=*), intent(in) :: name
      real(rk), parameter :: a = 0.2871_rk, b = 0.6133_rk  ! no mesh has nodes there

      call set_rock(scene%material%permeability_xx, scene%material%permeability_yy, 1.0_rk, 1.0_rk)
      select case (name)
      case ("series")
         allocate (scene%regions(2))
         scene%regions(1) = new_region("polygon", [a, b, b, a], [-1, -1, 2, 2]*1.0_rk, contrast)
         ! Its left side is the right one of the first.
         scene%regions(2) = new_region("half_plane", [b, b], [1.0_rk, 0.0_rk], 0.1_rk)
         exact = 1.0_rk/(a + (b - a)/contrast + (1.0_rk - b)/0.1_rk)
      case ("parallel")
         allocate (scene%regions(2))
         scene%regions(1) = new_region("band", [-1.0_rk, 2.0_rk], [a, a], contrast)
         scene%regions(1)%x_other = [-1.0_rk, 2.0_rk]
         scene%regions(1)%y_other = [b, b]
         scene%regions(2) = new_region("half_plane", [-1.0_rk, 2.0_rk], [b, b], 0.1_rk)
         exact = a + (b - a)*contrast + (1.0_rk - b)*0.1_rk
      case ("thin across")  ! 0.03 wide, narrower than cells may be
         allocate (scene%regions(1))
         scene%regions(1) = new_region("polygon", [a, a + 0.03_rk, a + 0.03_rk, a], &
                                       [-1, -1, 2, 2]*1.0_rk, 1.0_rk/contrast)
         exact = 1.0_rk/(0.97_rk + 0.03_rk*contrast)
      case ("thin along")
         allocate (scene%regions(1))
         scene%regions(1) = new_region("polygon", [-1, 2, 2, -1]*1.0_rk, &
                                       [b, b, b + 0.03_rk, b + 0.03_rk], contrast)
         exact = 0.97_rk + 0.03_rk*contrast
      case ("diagonal")  ! singular at the corners, p ~ r^(2/3)
         allocate (scene%regions(1))
         scene%regions(1) = new_region("half_plane", [0.0_rk, 1.0_rk], [0.0_rk, 1.0_rk], 3.0_rk)
         exact = sqrt(3.0_rk)
      case ("turned")  ! principal directions at 45 degrees, everywhere
         allocate (scene%regions(1))
         scene%regions(1) = new_region("polygon", [-1, 2, 2, -1]*1.0_rk, [-1, -1, 2, 2]*1.0_rk, &
                                       0.5_rk*(10.0_rk + 1.0_rk))
         scene%regions(1)%material%permeability_xy = 0.5_rk*(10.0_rk - 1.0_rk)
         exact = sqrt(10.0_rk)
      case ("turned layers")  ! 10 along x on one side of the diagonal, 10 along y on the other
         allocate (scene%regions(1))
         scene%material%permeability_xx = 10.0_rk
         scene%regions(1) = new_region("half_plane", [0.0_rk, 1.0_rk], [0.0_rk, 1.0_rk], 1.0_rk)
         scene%regions(1)%material%permeability_yy = 10.0_rk
         exact = sqrt(10.0_rk)
      case ("chessboard")  ! singular at the centre, p ~ r^0.44
         allocate (scene%regions(2))
         scene%regions(1) = new_region("polygon", [0.0_rk, 0.5_rk, 0.5_rk, 0.0_rk], &
                                       [0.0_rk, 0.0_rk, 0.5_rk, 0.5_rk], 10.0_rk)
         scene%regions(2) = new_region("polygon", [0.5_rk, 1.0_rk, 1.0_rk, 0.5_rk], &
                                       [0.5_rk, 0.5_rk, 1.0_rk, 1.0_rk], 10.0_rk)
         exact = sqrt(10.0_rk)
      case ("parabola")  ! the same twice: the later region counts
         allocate (scene%regions(2))
         scene%regions(1) = new_parabola([0.2_rk, 0.5_rk], contrast)
         scene%regions(2) = new_parabola([0.2_rk, 0.5_rk], 1.0_rk)
         exact = 1.0_rk
      case default
         error stop "unknown layers"
      end select
   end subroutine set_layers

   pure subroutine set_rock(xx, yy, permeability_xx, permeability_yy)
      real(rk), intent(out) :: xx, yy
      real(rk), intent(in) :: permeability_xx, permeability_yy

      xx = permeability_xx
      yy = permeability_yy
   end subroutine set_rock

   pure function new_region(shape, x, y, permeability) result(region)
      character(len=*), intent(in) :: shape
      real(rk), intent(in) :: x(:), y(:), permeability
      type(region_t) :: region

      region%shape = shape
      region%x = x
      region%y = y
      call set_rock(region%material%permeability_xx, region%material%permeability_yy, &
                    permeability, permeability)
   end function new_region

   pure function new_parabola(x_vertex, permeability) result(region)
      real(rk), intent(in) :: x_vertex(:), permeability
      type(region_t) :: region

      region%shape = "parabola"
      region%x_vertex = x_vertex
      region%y_vertex = spread(0.5_rk, 1, size(x_vertex))
      region%curvature = spread(1.0_rk, 1, size(x_vertex))
      call set_rock(region%material%permeability_xx, region%material%permeability_yy, &
                    permeability, permeability)
   end function new_parabola

   !> Each cell has the permeability at its centre.
   subroutine take_centres()
      integer(ik) :: c
      integer :: i
      logical :: is_in

      do c = 1, mesh%n_cells
         model%rock%permeability(:, c) = of(scene%regions(1), .false.)
         do i = 1, size(scene%regions)
            is_in = holds(scene%regions(i), cell_centre(mesh, c))
            if (is_in) model%rock%permeability(:, c) = of(scene%regions(i), .true.)
         end do
         model%rock%resistivity(:, :, c) = resistivity_of(model%rock%permeability(:, c), 1.0_rk)
      end do
      call discretize(mesh, model%rock, model%sides, model%regions, model%matrix, error)
      call stop_on(error)
   end subroutine take_centres

   pure function of(region, is_in) result(permeability)
      type(region_t), intent(in) :: region
      logical, intent(in) :: is_in
      real(rk) :: permeability(3)

      associate (m => region%material, around => scene%material)
         permeability = [around%permeability_xx, around%permeability_yy, around%permeability_xy]
         if (is_in) permeability = [m%permeability_xx, m%permeability_yy, m%permeability_xy]
      end associate
   end function of

   !> A region of these layers holds a point: its box, or the left of its line.
   pure logical function holds(region, xy)
      type(region_t), intent(in) :: region
      real(rk), intent(in) :: xy(2)

      if (region%shape == "half_plane") then
         holds = (region%x(2) - region%x(1))*(xy(2) - region%y(1)) &
                 - (region%y(2) - region%y(1))*(xy(1) - region%x(1)) > 0.0_rk
      else if (region%shape == "band") then
         holds = xy(2) > region%y(1) .and. xy(2) < region%y_other(1)
      else
         holds = xy(1) > minval(region%x) .and. xy(1) < maxval(region%x) .and. &
                 xy(2) > minval(region%y) .and. xy(2) < maxval(region%y)
      end if
   end function holds

   !> Through the right side.
   real(rk) function flow_out() result(flow)
      real(rk), allocatable :: flux(:)
      integer(ik) :: f, j, r

      flow = 0.0_rk
      associate (regions => model%regions)
         do r = 1, regions%n_regions
            allocate (flux(regions%flow_faces%length(r)))
            call regions%flux(r)%apply(state%unknowns(3, regions%blocks%of(r)), flux)
            do j = 1, size(flux, kind=ik)
               f = regions%flow_faces%at(r, j)
               if (mesh%face_side(f) == 2) flow = flow + 0.5_rk*face_length(mesh, f)*flux(j)
            end do
            deallocate (flux)
         end do
      end associate
   end function flow_out

   !> How far pressures leave those of the sides, 0 and 1.
   real(rk) function beyond_bounds() result(beyond)

      associate (pressure => state%unknowns(3, :mesh%n_cells))
         beyond = max(0.0_rk, maxval(pressure) - 1.0_rk, -minval(pressure))
      end associate
   end function beyond_bounds

   !> Of the pressure at the cells' centres, where layers in series or in parallel are exact.
   real(rk) function pressure_error() result(total)
      real(rk) :: drop, x, y, left
      integer(ik) :: c

      total = 0.0_rk
      do c = 1, mesh%n_cells
         associate (xy => cell_centre(mesh, c))
            x = xy(1)
            y = xy(2)
         end associate
         drop = x
         if (text_argument(1) == "series") then
            left = 0.2871_rk
            drop = exact*(min(x, left) + max(0.0_rk, min(x, 0.6133_rk) - left)/contrast &
                          + max(0.0_rk, x - 0.6133_rk)/0.1_rk)
         end if
         total = total + cell_area(mesh, c)*(state%unknowns(3, c) - 1.0_rk + drop)**2
      end do
      total = sqrt(total)
   end function pressure_error

end program layered_flow
