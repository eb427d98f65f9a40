!> The estimated size of a scene before meshing, and whether a machine has enough memory for it;
!! also the features of a scene. All numbers are real: those of a scene that is far too large exceed
!! the range of integers.
module app_size
   use app_warnings, only: show_warnings
   use base_errors, only: error_t
   use base_kinds, only: ik, lk, pi, rk
   use base_number, only: brief_text
   use base_plane, only: norm2, polygon_area
   use growth_network, only: network_of_scene, total_length
   use mechanics_results, only: touches
   use scene_outline, only: outline_of_scene, outline_t
   use scene_plausible, only: doubts_of_scene
   use scene_regime, only: find_regime, regime_words
   use scene_sheet, only: refuse, sheet_t
   use scene_sizes, only: sizes_text
   use scene_types, only: scene_t, time_t
   implicit none(type, external)
   private

   public :: check_size, describe_scene, estimate_t, size_of_scene

   !> Estimated size of a scene at the start of a run.
   type :: estimate_t
      real(rk) :: steps = 0.0_rk  !< number of regular steps
      real(rk) :: cells = 0.0_rk
      real(rk) :: fracture_cells = 0.0_rk
      real(rk) :: unknowns = 0.0_rk  !< unknowns of the body
      ! Lower bounds of memory [byte]
      real(rk) :: bytes_of_cells = 0.0_rk  !< mesh, matrix and its factors
      real(rk) :: bytes_of_contact = 0.0_rk  !< the full matrix on the fractures, or sparse factors
      real(rk) :: bytes_of_tables = 0.0_rk  !< tables, which are kept in memory
   end type estimate_t

   real(rk), parameter :: byte_per_cell = 8.0e3_rk  !< measured: 10e3 to 14e3 at 3e4 cells
   !> The sparse factors of the fractures' equations; measured: 15e3 to 20e3 at 5e4 to 1e5 cells.
   !! With growth the largest full matrix that is chosen instead (coarse_condensed).
   real(rk), parameter :: byte_per_cell_of_contact = 1.0e4_rk, byte_with_growth = 2.6e4_rk
   real(rk), parameter :: byte_per_value = 20.0_rk  !< bytes per value of a table
   real(rk), parameter :: values_per_step = 15.0_rk  !< values per row of history.csv
   real(rk), parameter :: values_per_probe = 6.0_rk
   real(rk), parameter :: values_per_fracture_cell = 10.0_rk
   !> Matrices are numbered with integers of 32 bits, and have up to 200 entries per cell.
   real(rk), parameter :: most_cells = real(huge(1_ik), rk)/200.0_rk
   real(rk), parameter :: most_fracture_cells = 1.0e6_rk
   real(rk), parameter :: most_steps = real(huge(1_ik), rk)

contains

   !> Estimate the size of a scene.
   function size_of_scene(scene, n_cells) result(estimate)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in), optional :: n_cells(2)  !< by the mesh library, where it is known
      type(estimate_t) :: estimate
      real(rk) :: length, touching_cells, values, written

      length = total_length(network_of_scene(scene))
      if (length > 0.0_rk) then
         estimate%fracture_cells = anint(length/usual_cell(scene))
      end if
      estimate%cells = anint(number_of_cells(scene, length))
      if (present(n_cells)) then
         estimate%cells = anint(n_cells(1))
         estimate%fracture_cells = n_cells(2)
      end if
      estimate%steps = real(scene%load%steps, rk)
      if (allocated(scene%load%factors)) then
         estimate%steps = estimate%steps*real(size(scene%load%factors), rk)
      end if
      estimate%unknowns = 4.0_rk*estimate%cells  ! two for each node of six-node triangles
      written = estimate%steps
      touching_cells = 0.0_rk
      if (scene%has_fluid()) then
         touching_cells = estimate%fracture_cells
         estimate%steps = number_of_steps(scene%time)
         estimate%unknowns = 3.0_rk*estimate%cells
         written = estimate%steps
         if (scene%output%interval > 0.0_rk) then
            written = min(written, scene%time%end/scene%output%interval)
         end if
      else if (any(touches(scene%fractures))) then
         touching_cells = estimate%fracture_cells
      end if
      estimate%bytes_of_cells = byte_per_cell*estimate%cells
      estimate%bytes_of_contact = 8.0_rk*(6.0_rk*touching_cells)**2
      if (scene%has_fluid() .and. scene%discretization%condensation /= "full") then
         estimate%bytes_of_contact = min(estimate%bytes_of_contact, estimate%cells &
                                         *merge(byte_with_growth, byte_per_cell_of_contact, &
                                                scene%growth%enabled))
      end if
      values = (values_per_step + values_per_probe*real(size(scene%probes), rk))*estimate%steps
      values = values + values_per_fracture_cell*estimate%fracture_cells*written
      estimate%bytes_of_tables = byte_per_value*values
   end function size_of_scene

   !> Mean size of the cells along fractures [m].
   pure real(rk) function usual_cell(scene) result(size)
      type(scene_t), intent(in) :: scene
      real(rk) :: length, cells
      integer(ik) :: i

      size = scene%discretization%size_fracture
      if (.not. any(scene%fractures%cell_size > 0.0_rk)) return
      length = 0.0_rk
      cells = 0.0_rk
      do i = 1, ubound(scene%fractures, 1)
         length = length + scene%fractures(i)%length()
         cells = cells + scene%fractures(i)%length()/scene%cell_size_of(i)
      end do
      size = length/cells
   end function usual_cell

   !> Number of steps of the given length, or the usual number of adaptive steps.
   pure real(rk) function number_of_steps(time)
      type(time_t), intent(in) :: time
      real(rk), parameter :: usual = 100.0_rk

      number_of_steps = usual
      if (time%step > 0.0_rk) then
         number_of_steps = aint(time%end/time%step*(1.0_rk - 1.0e-9_rk)) + 1.0_rk
         if (time%tolerance > 0.0_rk) number_of_steps = max(usual, number_of_steps)
      end if
   end function number_of_steps

   !> Number of cells before the mesh library has seen the scene: the integral of 1/area over the
   !! body. Sizes increase linearly with the
   !! distance from the fractures, up to half of that of the farthest point (size_field.cpp). The
   !! area within a distance d of n fractures of total length L is 2 L d + n pi d**2; since these
   !! areas overlap, the fraction exp(-(2 L d + n pi d**2)/area) of the body is farther away for
   !! random fractures (Boolean model: Chiu, Stoyan, Kendall, Mecke, Stochastic Geometry, 2013, ch.
   !! 3).
   function number_of_cells(scene, length) result(n)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: length  !< total length of all fractures [m]
      real(rk) :: n
      integer, parameter :: layers = 400
      real(rk), parameter :: cells_per_square = 4.0_rk/sqrt(3.0_rk)  ! equilateral triangles
      !> The distance beyond which a fraction of at most exp(-5) of the body lies.
      real(rk), parameter :: covered = 5.0_rk
      type(outline_t) :: outline
      real(rk) :: area, inner, outer, farthest, slope, d, nearest, n_fractures
      integer :: i

      if (scene%domain%shape == "disc") then
         area = pi*scene%domain%radius**2
      else if (scene%domain%shape == "rectangle") then
         associate (body => scene%domain)
            area = (body%x_max - body%x_min)*(body%y_max - body%y_min)
         end associate
      else
         outline = outline_of_scene(scene)
         area = abs(polygon_area(outline%corners))
      end if
      associate (body => scene%domain, far => scene%discretization%size_boundary, &
                 near => usual_cell(scene))
         n = cells_per_square*area/far**2
         if (.not. (length > 0.0_rk .and. near < far .and. area > 0.0_rk)) return
         n_fractures = real(size(scene%fractures), rk)
         ! 2 L d + n pi d**2 = covered*area, in a form that one long fracture does not cancel
         farthest = covered*area/(length + sqrt(length**2 + covered*area*n_fractures*pi))
         farthest = min(farthest, 0.5_rk*norm2([body%x_max - body%x_min, body%y_max - body%y_min]))
         slope = (far - near)/(0.5_rk*farthest)
         n = 0.0_rk
         inner = 0.0_rk
         nearest = 1.0e-2_rk*near  ! layers grow geometrically from there to the farthest
         do i = 1, layers
            d = nearest*(farthest/nearest)**(real(i, rk)/layers)
            outer = area*(1.0_rk - exp(-(2.0_rk*length*d + n_fractures*pi*d**2)/area))
            if (i == layers) outer = area
            n = n + cells_per_square*(outer - inner)/min(far, near + slope*d)**2
            inner = outer
         end do
      end associate
   end function number_of_cells

   !> Refuse a scene that is too large for the machine, or for this program on any machine.
   subroutine check_size(sheet, scene, memory, error, n_cells)
      type(sheet_t), intent(in) :: sheet  !< file of the scene
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: memory  !< memory of the machine [byte]
      type(error_t), allocatable, intent(out) :: error
      real(rk), intent(in), optional :: n_cells(2)  !< by the mesh library, where it is known
      type(estimate_t) :: size
      character(len=:), allocatable :: steps, cells, fracture_cells, needed
      real(rk) :: bytes

      size = size_of_scene(scene, n_cells)
      bytes = size%bytes_of_cells + size%bytes_of_contact + size%bytes_of_tables
      steps = "asks for about "//number(size%steps)//" steps"
      cells = "the sizes ask for about "//number(size%cells)//" cells"
      fracture_cells = "asks for about "//number(size%fracture_cells)//" fracture cells"
      needed = " need at least "//number(bytes*1.0e-9_rk)//" GB of memory, and this machine "// &
               "has "//number(memory*1.0e-9_rk)
      if (size%steps > most_steps) then
         call refuse_steps(steps//", and a run counts up to "//number(most_steps)// &
                           ": ask for fewer")
      else if (size%cells > most_cells) then
         call refuse_mesh("", cells//", and a run numbers up to "//number(most_cells)// &
                          ": give larger ones")
      else if (size%fracture_cells > most_fracture_cells) then
         call refuse_mesh("size_fracture", fracture_cells//", and a run has up to "// &
                          number(most_fracture_cells)//": give a larger one")
      else if (bytes <= memory) then
         return
      else if (2.0_rk*size%bytes_of_tables > bytes) then
         call refuse_steps(steps//"; their tables"//needed//": use fewer steps, or write "// &
                           "fields less often (interval of &output)")
      else if (size%bytes_of_contact > size%bytes_of_cells) then
         call refuse_mesh("size_fracture", fracture_cells//", which"//needed// &
                          ": give a larger one")
      else
         call refuse_mesh("", cells//" and "//number(size%unknowns)//" unknowns, which"//needed// &
                          ": give larger ones")
      end if

   contains

      subroutine refuse_steps(reason)
         character(len=*), intent(in) :: reason

         if (scene%has_fluid()) then
            call refuse(error, sheet, sheet%find("time"), "step", reason)
         else
            call refuse(error, sheet, sheet%find("load"), "steps", reason)
         end if
      end subroutine refuse_steps

      subroutine refuse_mesh(name, reason)
         character(len=*), intent(in) :: name, reason

         ! A scene has one of the two groups.
         call refuse(error, sheet, sheet%find("coarse") + sheet%find("fe"), name, reason)
      end subroutine refuse_mesh

   end subroutine check_size

   pure function number(x) result(text)
      real(rk), intent(in) :: x
      character(len=:), allocatable :: text

      text = brief_text(x, 3)
   end function number

   !> Print the scene's contents and its estimated size.
   subroutine describe_scene(scene, n_cells, unit)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: n_cells(2)  !< by the mesh library
      integer, intent(in) :: unit

      type(estimate_t) :: estimate
      real(rk) :: leakoff, length, toughness
      integer :: well

      associate (body => scene%domain)
         length = total_length(network_of_scene(scene))
         estimate = size_of_scene(scene, n_cells)
         write (unit, "(2a)") "scene:        ", trim(scene%name)
         if (len_trim(scene%title) > 0) write (unit, "(2a)") "title:        ", trim(scene%title)
         write (unit, "(a,2(es10.3,a))") "body:        ", body%x_max - body%x_min, " x", &
            body%y_max - body%y_min, " m, "//trim(merge("poroelastic", "elastic    ", &
                                                        scene%has_fluid()))
         write (unit, "(a,i0,a,es10.3,a)") "fractures:    ", size(scene%fractures), ", together", &
            length, " m"
         if (allocated(scene%regions)) write (unit, "(a,i0)") "regions:      ", size(scene%regions)
         if (scene%has_fluid()) write (unit, "(a,i0)") "wells:        ", size(scene%injections)
         write (unit, "(a,i0)") "probes:       ", size(scene%probes)
         if (scene%has_fluid()) then
            write (unit, "(a,es10.3,a,i0,a)") "time:        ", scene%time%end, " s in "// &
               trim(merge("about", "     ", scene%time%tolerance > 0.0_rk))//" ", &
               int(estimate%steps, lk), trim(merge(" chosen steps ", " regular steps", &
                                                   scene%time%tolerance > 0.0_rk))
         else if (allocated(scene%load%factors)) then
            write (unit, "(a,i0,2(a,es10.3),a,i0,a)") "load factors: ", &
               size(scene%load%factors), " in turn between", minval(scene%load%factors), &
               " and", maxval(scene%load%factors), ", ", scene%load%steps, " steps to each"
            write (unit, "(a)") "left out:     pressure, flow, coarse level"
         else
            write (unit, "(2(a,es10.3),a,i0,a)") "load factor: ", scene%load%from, " to", &
               scene%load%to, " in ", scene%load%steps, " steps"
            write (unit, "(a)") "left out:     pressure, flow, coarse level"
         end if
         write (unit, "(2a)") "tips:         ", trim(merge("growth     ", &
                                                           merge("intensities", "left out   ", &
                                                                 scene%growth%intensities), &
                                                           scene%growth%enabled))
         if (scene%discretization%chosen) write (unit, "(2a)") "sizes:        ", sizes_text(scene)
         if (allocated(scene%fluid%table_temperature)) write (unit, "(a,es9.3,a)") &
            "viscosity:    by temperature in fractures, in rock ", scene%fluid%viscosity, " Pa s"
         call find_regime(scene, toughness, leakoff, well)
         if (well > 0) write (unit, "(3a,es9.3,3a)") "regime:       ", &
            regime_words(toughness), ", K_m = ", toughness, " (well '", &
            trim(scene%injections(well)%name), "')"
         if (well > 0 .and. leakoff > 0.0_rk .and. leakoff <= huge(leakoff)) then
            write (unit, "(a,es9.3,a)") "leak-off:     C_m = ", leakoff, &
               " at the end, by the least compression"
         end if
         write (unit, "(2a)") "VTU files:    ", trim(merge("yes     ", "left out", &
                                                           scene%output%vtu))
         write (unit, "(a,i0,a,i0,a)") "about:        ", int(estimate%cells, lk), " cells, ", &
            int(estimate%fracture_cells, lk), " fracture cells"
      end associate
      call show_warnings(doubts_of_scene(scene), unit)
   end subroutine describe_scene

end module app_size
