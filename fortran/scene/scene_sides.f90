!> Conditions that a scene prescribes on the sides of the body, at one time or as functions of time.
module scene_sides
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: boundary_side_t, in_time, mean_in_time, normal_tractions, side_course_t
   public :: side_quantities, of_inflow, of_normal_traction, of_pressure, of_shear_traction
   public :: of_x_displacement, of_x_traction, of_y_displacement, of_y_traction

   !> Quantities that may change with time, by their names in a scene file.
   character(len=16), parameter :: side_quantities(8) = [character(len=16) :: &
                                                         "x_displacement", "y_displacement", &
                                                         "x_traction", "y_traction", &
                                                         "normal_traction", "shear_traction", &
                                                         "pressure", "inflow"]
   integer, parameter :: of_x_displacement = 1, of_y_displacement = 2, of_x_traction = 3, &
                         of_y_traction = 4, of_normal_traction = 5, of_shear_traction = 6, &
                         of_pressure = 7, of_inflow = 8

   !> Values of a quantity at the times of a course.
   type :: list_t
      real(rk), allocatable :: of(:)  !< (times) [unit of the quantity]; unallocated: constant
   end type list_t

   !> Values as functions of time: linear between the times, constant before the first and after the
   !! last one. At two equal times the value jumps, right after that time.
   type :: side_course_t
      real(rk), allocatable :: time(:)  !< in increasing order; unallocated: all constant [s]
      type(list_t) :: values(size(side_quantities))
   end type side_course_t

   !> Conditions on a side of the body at one time. Per component either displacement or total
   !! traction is prescribed; springs may act in addition to the traction.
   type :: boundary_side_t
      logical :: displacement_given(2) = .false.  !< x, y; .false.: traction is prescribed
      real(rk) :: displacement(2) = 0.0_rk  !< [m]
      real(rk) :: traction(2) = 0.0_rk  !< total traction [Pa]
      !> along the outward normal, and along the boundary with the body on the left [Pa]
      real(rk) :: normal_traction = 0.0_rk, shear_traction = 0.0_rk
      real(rk) :: spring(2) = 0.0_rk  !< traction opposite to the displacement, over it [Pa/m]
      logical :: pressure_given = .false.  !< .false.: inflow is prescribed
      real(rk) :: pressure = 0.0_rk  !< [Pa]
      logical :: inflow_given = .false.  !< .false., without a pressure: 0 is the default
      real(rk) :: inflow = 0.0_rk  !< volume per time and area into the body [m/s]
      logical :: temperature_given = .false.  !< .false.: the heat flux is prescribed
      real(rk) :: temperature = 0.0_rk  !< [K]
      real(rk) :: heat_flux = 0.0_rk  !< conducted into the body [W/m2]
      type(side_course_t) :: course
   contains
      procedure :: changes
      procedure :: set_time
      procedure :: pressure_changes
      procedure :: largest_stress
      procedure :: largest_displacement
   end type boundary_side_t

contains

   !> A quantity of the side changes with time.
   elemental logical function changes(self)
      class(boundary_side_t), intent(in) :: self

      changes = allocated(self%course%time)
   end function changes

   !> Set the values at a time, and the mean inflow since an earlier time: the inflowing volume then
   !! does not depend on the length of the steps.
   elemental subroutine set_time(self, time, since)
      class(boundary_side_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      real(rk), intent(in) :: since  !< at most `time` [s]

      if (.not. self%changes()) return
      call set(of_x_displacement, self%displacement(1))
      call set(of_y_displacement, self%displacement(2))
      call set(of_x_traction, self%traction(1))
      call set(of_y_traction, self%traction(2))
      call set(of_normal_traction, self%normal_traction)
      call set(of_shear_traction, self%shear_traction)
      call set(of_pressure, self%pressure)
      associate (list => self%course%values(of_inflow))
         if (allocated(list%of)) self%inflow = mean_in_time(self%course%time, list%of, since, time)
      end associate

   contains

      pure subroutine set(quantity, value)
         integer, intent(in) :: quantity
         real(rk), intent(inout) :: value  !< [unit of the quantity]

         associate (list => self%course%values(quantity))
            if (allocated(list%of)) value = in_time(self%course%time, list%of, time)
         end associate
      end subroutine set

   end subroutine set_time

   !> Changes of the pressure until a time, by their ages: all whose ages lie between halvings of
   !! the time are one, with the mean of their ages. Without any, one of 0 with the age of the time.
   pure subroutine pressure_changes(self, initial, time, age, change)
      class(boundary_side_t), intent(in) :: self
      real(rk), intent(in) :: initial  !< pressure before the time 0 [Pa]
      real(rk), intent(in) :: time  !< [s]
      real(rk), allocatable, intent(out) :: age(:)  !< [s]
      real(rk), allocatable, intent(out) :: change(:)  !< [Pa]
      integer, parameter :: n = 12
      real(rk) :: ends(2), part
      real(rk) :: sums(3, n)  ! of changes, of their sizes, and of these times ages
      integer :: i, k

      sums = 0.0_rk
      associate (list => self%course%values(of_pressure))
         if (.not. allocated(list%of)) then
            call add(self%pressure - initial, time, sums(:, 1))
         else
            call add(list%of(1) - initial, time, sums(:, 1))
            do k = 2, size(list%of)
               associate (first => self%course%time(k - 1), last => self%course%time(k), &
                          rise => list%of(k) - list%of(k - 1))
                  if (.not. first < time) exit
                  do i = 1, n
                     ends = [max(time - last, merge(0.0_rk, time/2**i, i == n)), &
                             min(time - first, time/2**(i - 1))]
                     if (ends(2) < ends(1)) cycle
                     part = 1.0_rk
                     if (last > first) part = (ends(2) - ends(1))/(last - first)
                     call add(part*rise, 0.5_rk*sum(ends), sums(:, i))
                     if (.not. last > first) exit
                  end do
               end associate
            end do
         end if
      end associate
      age = [time]
      change = [0.0_rk]
      if (.not. any(sums(2, :) > 0.0_rk)) return
      age = pack(sums(3, :)/max(sums(2, :), tiny(1.0_rk)), sums(2, :) > 0.0_rk)
      change = pack(sums(1, :), sums(2, :) > 0.0_rk)

   contains

      !> Add a change to the sums of those between two halvings.
      pure subroutine add(rise, since, sums)
         real(rk), intent(in) :: rise  !< [Pa]
         real(rk), intent(in) :: since  !< [s]
         real(rk), intent(inout) :: sums(3)  !< [Pa, Pa, Pa s]

         sums = sums + [rise, abs(rise), abs(rise)*since]
      end subroutine add

   end subroutine pressure_changes

   !> Value at a time, from those at the times of a course [unit of the values].
   pure real(rk) function in_time(times, values, time)
      real(rk), intent(in) :: times(:)  !< in increasing order [s]
      real(rk), intent(in) :: values(:)
      real(rk), intent(in) :: time  !< [s]
      integer(ik) :: k

      k = count(times < time, kind=ik)
      if (k == 0) then
         in_time = values(1)
      else if (k == size(times)) then
         in_time = values(k)
      else
         associate (share => (time - times(k))/(times(k + 1) - times(k)))
            in_time = (1.0_rk - share)*values(k) + share*values(k + 1)
         end associate
      end if
   end function in_time

   !> Mean value between two times, or the value at a time if they are equal [unit of the values].
   pure real(rk) function mean_in_time(times, values, since, time) result(mean)
      real(rk), intent(in) :: times(:)  !< in increasing order [s]
      real(rk), intent(in) :: values(:)
      real(rk), intent(in) :: since, time  !< [s]
      real(rk) :: ends(2)
      integer(ik) :: k

      mean = in_time(times, values, time)
      if (.not. time > since) return
      mean = values(1)*max(0.0_rk, min(time, times(1)) - since) &
             + values(size(values))*max(0.0_rk, time - max(since, times(size(times))))
      do k = 2, size(times, kind=ik)
         ends = [max(since, times(k - 1)), min(time, times(k))]
         if (.not. ends(2) > ends(1)) cycle
         ! Linear in between: the mean is the value in the middle.
         mean = mean + (ends(2) - ends(1))*in_time(times, values, 0.5_rk*sum(ends))
      end do
      mean = mean/(time - since)
   end function mean_in_time

   !> Traction along the outward normal of the sides of a rectangle: left, right, bottom, top [Pa].
   pure function normal_tractions(sides) result(normal)
      type(boundary_side_t), intent(in) :: sides(4)
      real(rk) :: normal(4)

      normal = [-sides(1)%traction(1), sides(2)%traction(1), -sides(3)%traction(2), &
                sides(4)%traction(2)] + sides%normal_traction
   end function normal_tractions

   !> Largest absolute value of all tractions and pressures at any time [Pa].
   elemental real(rk) function largest_stress(self) result(largest)
      class(boundary_side_t), intent(in) :: self
      integer :: k

      largest = max(maxval(abs(self%traction)), abs(self%normal_traction), &
                    abs(self%shear_traction), abs(self%pressure))
      do k = of_x_traction, of_pressure
         associate (list => self%course%values(k))
            if (allocated(list%of)) largest = max(largest, maxval(abs(list%of)))
         end associate
      end do
   end function largest_stress

   !> Largest absolute displacement at any time [m].
   elemental real(rk) function largest_displacement(self) result(largest)
      class(boundary_side_t), intent(in) :: self
      integer :: k

      largest = maxval(abs(self%displacement))
      do k = of_x_displacement, of_y_displacement
         associate (list => self%course%values(k))
            if (allocated(list%of)) largest = max(largest, maxval(abs(list%of)))
         end associate
      end do
   end function largest_displacement

end module scene_sides
