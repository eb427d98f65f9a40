!> Sizes that a scene leaves open: cells, increments and windows of each fracture follow from its
!! length and the tolerance of the run (docs/theory.md, "Default sizes").
module scene_sizes
   use base_kinds, only: ik, rk
   use base_number, only: brief_text
   use base_tolerances, only: same_place
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: choose_sizes, sizes_text

   !> Cells along a fracture at the usual tolerance, along all of them, and along one in any case.
   !! Errors are of first order in their size.
   real(rk), parameter :: usual_cells = 20.0_rk, together = 400.0_rk
   real(rk), parameter :: fewest_cells = 10.0_rk, most_cells = 80.0_rk
   real(rk), parameter :: usual_tolerance = 0.01_rk

   !> Edge of a window over the length of its fracture, and the least that changes K little; over
   !! twice the length, that with its mirror image, where the fracture ends on a side of the body.
   real(rk), parameter :: usual_window = 5.0_rk, least_window = 2.0_rk

   !> Larger windows, over the body's shorter edge, are the body (twolevel_refinement).
   real(rk), parameter :: largest_window = 0.3_rk

   !> Cells far from the fractures over the body's shorter edge.
   real(rk), parameter :: share_of_body = 0.05_rk

contains

   !> Give the sizes that are still 0 their values. Where all fractures have the same, or the scene
   !! gives it, fractures have none of their own. That of the scene is then the smallest one.
   pure subroutine choose_sizes(scene)
      type(scene_t), intent(inout) :: scene
      real(rk) :: edge

      if (scene%growth%increments == "auto") then
         scene%growth%increments = merge("by_length", "constant ", follow_lengths(scene))
      end if
      associate (body => scene%domain, sizes => scene%discretization, f => scene%fractures)
         edge = min(body%x_max - body%x_min, body%y_max - body%y_min)
         if (size(f) > 0 .and. .not. sizes%size_fracture > 0.0_rk) then
            call choose_cells(scene, edge)
            sizes%chosen = .true.
         end if
         if (.not. sizes%size_boundary > 0.0_rk) then
            sizes%size_boundary = decimal(share_of_body*edge)
            if (size(f) > 0) sizes%size_boundary = &
               max(sizes%size_boundary, sizes%size_fracture, maxval(f%cell_size))
            sizes%chosen = .true.
         end if
         call choose_increments(scene)
         if (.not. (scene%has_fluid() .and. scene%growth%intensities)) return
         if (size(f) == 0 .or. sizes%window > 0.0_rk .or. sizes%window_is_body) return
         call choose_windows(scene, edge)
         sizes%chosen = .true.
      end associate
   end subroutine choose_sizes

   !> Whether increments are to follow the present lengths by default: where the scene gives neither
   !! them nor cells.
   pure logical function follow_lengths(scene) result(follow)
      type(scene_t), intent(in) :: scene

      follow = scene%has_fluid() .and. scene%growth%law == "equilibrium"
      follow = follow .and. .not. (scene%growth%increment > 0.0_rk .or. &
                                   scene%discretization%size_fracture > 0.0_rk)
      associate (f => scene%fractures)
         follow = follow .and. .not. any(f%increment > 0.0_rk .or. f%cell_size > 0.0_rk)
      end associate
   end function follow_lengths

   !> A share of each fracture's length.
   pure subroutine choose_cells(scene, edge)
      type(scene_t), intent(inout) :: scene
      real(rk), intent(in) :: edge  !< shorter one of the body [m]
      real(rk) :: cells, tolerance, largest
      integer :: i

      tolerance = scene%time%tolerance
      if (.not. tolerance > 0.0_rk) tolerance = usual_tolerance
      cells = min(usual_cells, together/size(scene%fractures))*(usual_tolerance/tolerance)
      cells = min(max(cells, fewest_cells), most_cells)
      largest = edge
      if (scene%discretization%size_boundary > 0.0_rk) largest = scene%discretization%size_boundary
      do i = 1, size(scene%fractures)
         associate (fracture => scene%fractures(i))
            if (fracture%cell_size > 0.0_rk) cycle
            fracture%cell_size = min(decimal(fracture%length()/cells), largest)
         end associate
      end do
      call share_value(scene%fractures%cell_size, scene%discretization%size_fracture)
   end subroutine choose_cells

   !> The fine mesh size, or without a fluid the size of elements; there all tips in equilibrium
   !! have the smallest one (mechanics_state).
   pure subroutine choose_increments(scene)
      type(scene_t), intent(inout) :: scene
      real(rk) :: ratio
      integer(ik) :: i

      if (scene%growth%increment > 0.0_rk) return
      ratio = 1.0_rk
      if (scene%has_fluid()) ratio = scene%discretization%fine_ratio
      scene%growth%increment = ratio*scene%discretization%size_fracture
      if (size(scene%fractures) == 0) return
      if (.not. any(scene%fractures%cell_size > 0.0_rk)) return
      if (.not. scene%has_fluid() .and. scene%growth%law == "equilibrium") then
         scene%growth%increment = scene%smallest_cell()
         return
      end if
      do i = 1, size(scene%fractures, kind=ik)
         associate (fracture => scene%fractures(i))
            if (.not. fracture%increment > 0.0_rk) fracture%increment = ratio*scene%cell_size_of(i)
         end associate
      end do
      call share_value(scene%fractures%increment, scene%growth%increment)
   end subroutine choose_increments

   !> Squares of some lengths of the fracture, or the body where they would not fit into it, or
   !! where all of them together would be larger than it.
   pure subroutine choose_windows(scene, edge)
      type(scene_t), intent(inout) :: scene
      real(rk), intent(in) :: edge  !< shorter one of the body [m]
      real(rk), parameter :: tips = 2.0_rk  ! of a fracture, at most
      real(rk) :: length(size(scene%fractures)), window(size(scene%fractures))
      integer :: i

      length = [(scene%fractures(i)%length()*merge(2, 1, ends_on_side(scene, i)), &
                 i=1, size(scene%fractures))]
      window = scene%fractures%window
      where (.not. window > 0.0_rk) window = decimal(min(usual_window*length, largest_window*edge))
      associate (body => scene%domain)
         if (body%shape /= "rectangle" .or. scene%has_points() .or. &
             any(window < least_window*length .and. .not. scene%fractures%window > 0.0_rk) .or. &
             tips*sum(window**2) > (body%x_max - body%x_min)*(body%y_max - body%y_min)) then
            scene%discretization%window_is_body = .true.
            scene%fractures%window = 0.0_rk
            return
         end if
      end associate
      scene%fractures%window = window
      call share_value(scene%fractures%window, scene%discretization%window)
   end subroutine choose_windows

   !> Whether an end of a fracture lies on a side of the rectangle.
   pure logical function ends_on_side(scene, i)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: i  !< fracture
      integer :: ends(2)

      associate (body => scene%domain, x => scene%fractures(i)%x, y => scene%fractures(i)%y)
         ends = [min(1, size(x), size(y)), min(size(x), size(y))]
         ends_on_side = .false.
         if (ends(1) == 0) return
         ends_on_side = any(abs([x(ends) - body%x_min, x(ends) - body%x_max, &
                                 y(ends) - body%y_min, y(ends) - body%y_max]) &
                            <= same_place*max(body%x_max - body%x_min, body%y_max - body%y_min))
      end associate
   end function ends_on_side

   !> A number to nine digits: the rounding of coordinates is to change no mesh.
   elemental real(rk) function decimal(x)
      real(rk), intent(in) :: x  !< [m]
      character(len=16) :: digits

      decimal = x
      if (.not. (x > 0.0_rk .and. x < huge(1.0_rk))) return
      write (digits, "(es16.8e3)") x
      read (digits, "(es16.8e3)") decimal
   end function decimal

   !> The smallest is that of all, and of the others what they have themselves.
   pure subroutine share_value(own, of_scene)
      real(rk), intent(inout) :: own(:)  !< (fractures) [m]
      real(rk), intent(out) :: of_scene  !< [m]

      of_scene = minval(own)
      where (own <= of_scene) own = 0.0_rk
   end subroutine share_value

   !> The sizes of a scene in words, from the smallest to the largest of its fractures.
   pure function sizes_text(scene) result(text)
      type(scene_t), intent(in) :: scene
      character(len=:), allocatable :: text
      integer(ik) :: i, n

      n = size(scene%fractures, kind=ik)
      text = "cells up to "//metres(scene%discretization%size_boundary)
      if (n == 0) return
      text = "cells "//range_text([(scene%cell_size_of(i), i=1, n)])//" along fractures, up to "// &
             metres(scene%discretization%size_boundary)//" elsewhere"
      if (.not. scene%growth%intensities) return
      if (scene%growth%enabled) text = text//"; increments "// &
                                       range_text([(scene%increment_of(i), i=1, n)])
      if (.not. scene%has_fluid()) return
      if (scene%discretization%window_is_body) then
         text = text//"; one window, the body"
      else
         text = text//"; windows "//range_text([(scene%window_of(i), i=1, n)])
      end if
   end function sizes_text

   !> From the smallest to the largest, or the one that all are.
   pure function range_text(sizes) result(text)
      real(rk), intent(in) :: sizes(:)  !< [m]
      character(len=:), allocatable :: text

      text = metres(maxval(sizes))
      if (maxval(sizes) > minval(sizes)) text = brief_text(minval(sizes), 3)//" to "//text
   end function range_text

   pure function metres(x) result(text)
      real(rk), intent(in) :: x  !< [m]
      character(len=:), allocatable :: text

      text = brief_text(x, 3)//" m"
   end function metres

end module scene_sizes
