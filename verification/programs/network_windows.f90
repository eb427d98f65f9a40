!> Stress intensity factors of networks from windows of several sizes, and from the whole body as
!! one window, against known ones (verification/windows_of_scenes).
!!
!! The fluid keeps its pressure and the rock is hardly porous: the same body without a fluid, with
!! that pressure on the faces, has the same K, found there on adaptive meshes without coarse level
!! or windows. Coarse cells are 20 mm, the elements of the windows 10 mm at the fractures.
!!
!! Argument: `few` networks or `all`. Writes values.csv, a row per tip and window, and summary.csv,
!! a row per window: 0 stands for the body.
program network_windows
   use base_kinds, only: ik, pi, rk
   use fine_tip_types, only: intensity_t
   use mechanics_simulation, only: mechanics_simulation_t
   use report_simulation, only: simulation_t
   use twolevel_state, only: two_levels_t
   use verification_files, only: finish, table_t, text_argument
   use verification_intensities, only: between, group, open_scene, run_to_intensities, &
                                       write_faces, write_rock
   implicit none(type, external)

   real(rk), parameter :: slope = sqrt(0.5_rk)  !< x and y of a length at 45 degrees [-]
   real(rk), parameter :: closed = 6.8_rk, open = 24.0_rk  !< pressure of the fluid [MPa]
   real(rk), parameter :: windows(5) = [0.05_rk, 0.1_rk, 0.2_rk, 0.5_rk, 0.0_rk]  !< 0: body [m]
   real(rk), parameter :: nothing = 1.0e3_rk  !< K of tips that stay out [Pa m^1/2]
   integer(ik), parameter :: few = 4

   !> Fractures in a square body under -20 and -10 MPa.
   type :: network_t
      real(rk), allocatable :: ends(:, :)  !< (4, n) x and y of the first end, x and y of the other
      real(rk) :: pressure  !< of the fluid [MPa]
      real(rk) :: friction  !< [-]
   end type network_t

   type(table_t) :: table
   real(rk), allocatable :: values(:, :)  !< window, error, stated, cpu of the windows
   real(rk) :: cpu(size(windows)) = 0.0_rk, cpu_known = 0.0_rk  !< [s]
   integer(ik) :: i

   allocate (values(3, 0))
   call table%open("values.csv", "network,tip,window_m,k1_known,k2_known,k1,k2,k1_corrected,"// &
                   "k2_corrected,error,stated")
   call compare(1_ik, two_beside(0.1_rk, open))
   call compare(2_ik, two_beside(0.1_rk, closed))
   call compare(3_ik, crossed([1.0_rk, 1.0_rk], [0.2_rk, 95.0_rk]))
   call compare(few, crossed([1.09_rk, 1.0755_rk], [0.1_rk, 110.0_rk]))  ! 50 mm from a tip
   if (text_argument(1) == "all") then
      call compare(5_ik, in_line(0.028_rk, closed))
      call compare(6_ik, in_line(0.028_rk, open))
      call compare(7_ik, network_t(reshape([0.85_rk, 0.9_rk, 1.15_rk, 1.1_rk, &  ! T
                                            1.0_rk, 1.0_rk, 0.98_rk, 1.12_rk], [4, 2]), &
                                   closed, 0.3_rk))
      call compare(8_ik, network_t(reshape([1.892_rk, 0.968_rk, 1.968_rk, 1.032_rk], [4, 1]), &
                                   closed, 0.3_rk))  ! a tip 32 mm from a side
      call compare(9_ik, network_t(reshape([1.85_rk, 0.9_rk, 2.0_rk, 1.0_rk], [4, 1]), closed, &
                                   0.3_rk))  ! ends on a side
      call compare(10_ik, scene_c6())
      call compare(11_ik, scene_d4())
      do i = 12, 23
         call compare(i, drawn(merge(closed, open, mod(i, 2_ik) == 0)))
      end do
   end if
   call table%close()
   call summarize()
   call finish()

contains

   !> Parallel fractures at 45 degrees, 28 mm apart.
   pure function two_beside(length, pressure) result(network)
      real(rk), intent(in) :: length  !< [m]
      real(rk), intent(in) :: pressure  !< [MPa]
      type(network_t) :: network
      real(rk), parameter :: away(4) = 0.028_rk*slope*[-1.0_rk, 1.0_rk, -1.0_rk, 1.0_rk]
      real(rk) :: first(4)

      first = 1.0_rk + 0.5_rk*length*slope*[-1.0_rk, -1.0_rk, 1.0_rk, 1.0_rk]
      network = network_t(reshape([first, first + away], [4, 2]), pressure, 0.5_rk)
   end function two_beside

   !> Fractures of 0.2 m in one line, their tips face to face.
   pure function in_line(gap, pressure) result(network)
      real(rk), intent(in) :: gap  !< [m]
      real(rk), intent(in) :: pressure  !< [MPa]
      type(network_t) :: network
      real(rk) :: first(4)

      first = 1.0_rk + 0.1_rk*slope*[-1.0_rk, -1.0_rk, 1.0_rk, 1.0_rk]
      network = network_t(reshape([first, first + slope*(0.2_rk + gap)], [4, 2]), pressure, 0.5_rk)
   end function in_line

   !> One of 0.3 m at 40 degrees and another one across, which slip.
   pure function crossed(centre, other) result(network)
      real(rk), intent(in) :: centre(2)  !< of the other one [m]
      real(rk), intent(in) :: other(2)  !< its length [m] and direction [degree]
      type(network_t) :: network

      network = network_t(reshape([along([1.0_rk, 1.0_rk], 0.3_rk, 40.0_rk), &
                                   along(centre, other(1), other(2))], [4, 2]), closed, 0.3_rk)
   end function crossed

   !> The fractures of scene C6.
   pure function scene_c6() result(network)
      type(network_t) :: network

      network = network_t(reshape([0.751_rk, 1.208_rk, 0.849_rk, 1.192_rk, &
                                   0.965_rk, 0.965_rk, 1.035_rk, 1.035_rk, &
                                   1.144_rk, 0.780_rk, 1.256_rk, 0.831_rk], [4, 3]), 7.5_rk, 0.5_rk)
   end function scene_c6

   !> Those of scene D4.
   pure function scene_d4() result(network)
      type(network_t) :: network

      network = network_t(reshape([1.0_rk, 1.15_rk, 1.0_rk, 0.85_rk, &
                                   0.85_rk, 0.97_rk, 1.15_rk, 1.03_rk, &
                                   0.65_rk, 1.1_rk, 0.65_rk, 0.9_rk, &
                                   1.4_rk, 1.06_rk, 1.28_rk, 0.94_rk], [4, 4]), 8.0_rk, 0.5_rk)
   end function scene_d4

   !> Three fractures, no two nearer to each other than 20 mm.
   function drawn(pressure) result(network)
      real(rk), intent(in) :: pressure  !< [MPa]
      type(network_t) :: network
      real(rk) :: ends(4, 3), centre(2)
      integer(ik) :: n

      n = 0
      do while (n < 3)
         centre = [between(0.8_rk, 1.2_rk), between(0.8_rk, 1.2_rk)]
         ends(:, n + 1) = along(centre, between(0.1_rk, 0.25_rk), between(20.0_rk, 70.0_rk))
         if (least_distance(ends(:, :n), ends(:, n + 1)) > 0.02_rk) n = n + 1
      end do
      network = network_t(ends, pressure, 0.35_rk)
   end function drawn

   !> Both ends of a fracture.
   pure function along(centre, length, deg) result(ends)
      real(rk), intent(in) :: centre(2), length  !< [m]
      real(rk), intent(in) :: deg
      real(rk) :: ends(4)
      real(rk) :: half(2)

      associate (angle => deg*pi/180.0_rk)
         half = 0.5_rk*length*[cos(angle), sin(angle)]
      end associate
      ends = [centre - half, centre + half]
   end function along

   !> Distance of a fracture to others, from points along them [m].
   pure real(rk) function least_distance(others, one)
      real(rk), intent(in) :: others(:, :), one(:)  !< (4, n), (4) ends [m]
      integer, parameter :: n = 40
      integer :: a, b, k

      least_distance = huge(1.0_rk)
      do k = 1, size(others, 2)
         do a = 0, n
            do b = 0, n
               least_distance = min(least_distance, norm2(point(one, a) - point(others(:, k), b)))
            end do
         end do
      end do
   end function least_distance

   pure function point(ends, place)
      real(rk), intent(in) :: ends(4)  !< [m]
      integer, intent(in) :: place  !< 0 .. 40
      real(rk) :: point(2)

      point = ends(:2) + (ends(3:) - ends(:2))*place/40.0_rk
   end function point

   !> A network in all windows.
   subroutine compare(number, network)
      integer(ik), intent(in) :: number
      type(network_t), intent(in) :: network
      type(mechanics_simulation_t), allocatable :: body
      type(two_levels_t), allocatable :: levels
      integer(ik) :: tip, w

      allocate (body)
      call write_scene("solid.nml", network)
      call run("solid.nml", body, cpu_known)
      do w = 1, size(windows, kind=ik)
         allocate (levels)
         call write_scene("fluid.nml", network, windows(w))
         call run("fluid.nml", levels, cpu(w))
         do tip = 1, size(levels%tip, kind=ik)
            call note(number, tip, windows(w), body%tip(tip)%intensity, levels%tip(tip)%intensity)
         end do
         deallocate (levels)
      end do
   end subroutine compare

   !> A scene until its first state with intensities.
   subroutine run(path, simulation, cpu_s)
      character(len=*), intent(in) :: path
      class(simulation_t), intent(inout) :: simulation
      real(rk), intent(inout) :: cpu_s  !< what has been used so far [s]
      real(rk) :: before, after

      call cpu_time(before)
      call run_to_intensities(path, simulation)
      call cpu_time(after)
      cpu_s = cpu_s + after - before
   end subroutine run

   !> The scene's file, with a fluid if there is a window.
   subroutine write_scene(path, network, window)
      character(len=*), intent(in) :: path
      type(network_t), intent(in) :: network
      real(rk), intent(in), optional :: window  !< [m]
      integer :: k, unit

      call open_scene(path, unit)
      do k = 1, size(network%ends, 2)
         associate (ends => network%ends(:, k))
            write (unit, group) "&fracture name = 'f", k, "', friction = ", network%friction
            write (unit, group) "  dilation_deg = 1.0, x = ", ends(1), ", ", ends(3)
            write (unit, group) "  y = ", ends(2), ", ", ends(4)
         end associate
         call write_faces(unit, network%pressure, present(window))
      end do
      call write_rock(unit, 0.2_rk, network%pressure, present(window))
      if (.not. present(window)) then
         write (unit, group) "&fe size_fracture = 0.002, size_boundary = 0.2 /"
         write (unit, group) "&adaptive enabled = .true., tolerance = 3.0e-4, passes = 10 /"
      else
         write (unit, group) "&coarse size_fracture = 0.02, size_boundary = 0.1 /"
         if (window > 0.0_rk) then
            write (unit, group) "&fine window = ", window, " /"
         else
            write (unit, group) "&fine window = 'body' /"
         end if
      end if
      close (unit)
   end subroutine write_scene

   !> One tip, unless it sticks. Errors are shares of the magnitude of both intensities.
   subroutine note(number, tip, window, known, found)
      integer(ik), intent(in) :: number, tip
      real(rk), intent(in) :: window  !< [m]
      type(intensity_t), intent(in) :: known, found
      real(rk) :: error, scale, stated

      scale = hypot(known%k1, known%k2)
      if (scale <= nothing) return
      error = max(abs(found%k1 - known%k1), abs(found%k2 - known%k2))/scale
      stated = max(found%k1_error, found%k2_error)/scale
      call table%row([real([number, tip], rk), window, known%k1, known%k2, found%k1, found%k2, &
                      found%k1_corrected, found%k2_corrected, error, stated])
      values = reshape([values, window, error, stated], [3, size(values, 2) + 1])
   end subroutine note

   !> Per window: shares that hold, errors, processor time.
   subroutine summarize()
      integer(ik) :: w

      call table%open("summary.csv", "window_m,values,share,mean_error,largest_error,"// &
                      "mean_stated,cpu_s,cpu_known_s")
      do w = 1, size(windows, kind=ik)
         associate (here => abs(values(1, :) - windows(w)) <= 0.0_rk, error => values(2, :), &
                    stated => values(3, :))
            associate (n => real(count(here), rk))
               call table%row([windows(w), n, count(here .and. error <= stated)/n, &
                               sum(error, mask=here)/n, maxval(error, mask=here), &
                               sum(stated, mask=here)/n, cpu(w), cpu_known])
            end associate
         end associate
      end do
      call table%close()
   end subroutine summarize

end program network_windows
